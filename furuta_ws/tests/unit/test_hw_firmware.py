"""The reference firmware: it obeys the host, and nobody when the host is silent."""

from __future__ import annotations

import pytest

from furuta_hw import frames
from furuta_hw.firmware import Firmware
from furuta_hw.frames import ARMED, FAULT, WATCHDOG, FrameReader, encode

SESSION = 77
DOG = 5


def rig(armed: bool = True) -> Firmware:
    """A firmware in a session, armed and driven at code 100."""
    firmware = Firmware(-2048, 2047, 0)
    firmware.receive(encode(frames.Hello(frames.VERSION, SESSION, 1000, DOG)))
    sample(firmware)
    if armed:
        firmware.receive(encode(frames.Arm(SESSION, firmware.number)))
        drive(firmware)
        assert firmware.code == 100
    return firmware


def sample(firmware: Firmware) -> frames.Sensors:
    """One sample's frame."""
    last = FrameReader().feed(firmware.sample(0, 0, 0))[-1]
    assert isinstance(last, frames.Sensors)
    return last


def drive(firmware: Firmware, code: int = 100, **other: int) -> None:
    """A drive frame for the newest sample."""
    given = {"session": SESSION, "sample": firmware.number, "code": code} | other
    firmware.receive(encode(frames.Drive(**given)))


def test_nothing_goes_out_before_hello() -> None:
    """A rig without a host is silent and obeys nobody."""
    firmware = Firmware(-2048, 2047, 0)
    firmware.receive(encode(frames.Arm(0, 0)) + encode(frames.Drive(0, 0, 500)))
    assert firmware.sample(0, 0, 0) == b""
    assert firmware.code == 0


def test_silence_is_zero_within_the_watchdog() -> None:
    """The watchdog's sample count after the last one answered the drive is at zero, and latched."""
    firmware = rig()
    for k in range(1, DOG + 1):
        status = sample(firmware)
        assert firmware.code == (100 if k < DOG else 0)
        assert status.drive == 100  # what was in force up to this sample
    assert status.status == WATCHDOG
    drive(firmware)
    assert firmware.code == 0
    firmware.receive(encode(frames.Arm(SESSION, firmware.number)))
    drive(firmware, 50)
    assert firmware.code == 50
    assert sample(firmware).status == ARMED


def test_a_host_in_time_keeps_it_alive() -> None:
    """Answers to every sample, or to every third, feed the watchdog."""
    firmware = rig()
    for k in range(100):
        status = sample(firmware)
        assert status.status == ARMED
        if k % 3 == 0:
            drive(firmware, k)
            assert firmware.code == k


def test_repeated_and_late_frames_feed_no_watchdog() -> None:
    """The same frame for ever, or answers to old samples, do not keep the drive on."""
    firmware = rig()
    old = firmware.number
    for _ in range(DOG):
        drive(firmware, 100, sample=old)
        sample(firmware)
    assert firmware.code == 0
    firmware = rig()
    sample(firmware)
    drive(firmware, 200)
    drive(firmware, 300, sample=firmware.number - 1)
    assert firmware.code == 200
    assert firmware.discarded == 1


@pytest.mark.parametrize(
    "other", [{"session": SESSION + 1}, {"code": 2048}, {"sample": 1000}, {"code": -2049}]
)
def test_what_is_not_for_now_is_discarded(other: dict[str, int]) -> None:
    """Another session's frame, a code beyond the converter, a sample that is yet to come."""
    firmware = rig()
    drive(firmware, **({"code": 500} | other))
    assert firmware.code == 100
    assert sample(firmware).discarded == 1


def test_stop_and_hello_mean_zero() -> None:
    """Both disarm; a new session ignores the old one's frames."""
    firmware = rig()
    firmware.receive(encode(frames.Stop(SESSION)))
    assert (firmware.code, firmware.armed) == (0, False)
    firmware = rig()
    firmware.receive(encode(frames.Hello(frames.VERSION, SESSION + 1, 1000, DOG)))
    assert (firmware.code, firmware.armed, firmware.number) == (0, False, 0)
    drive(firmware)
    assert firmware.code == 0


def test_another_version_gets_no_stream() -> None:
    """It is told ours, and nothing more."""
    firmware = rig()
    firmware.receive(encode(frames.Hello(frames.VERSION + 1, 9, 1000, DOG)))
    (welcome,) = FrameReader().feed(firmware.sample(0, 0, 0))
    assert welcome == frames.Welcome(frames.VERSION, 9, 1000, DOG)
    assert firmware.sample(0, 0, 0) == b""


def test_a_fault_of_the_rig_stops_it_and_forbids_arming() -> None:
    """As an emergency stop or an amplifier's fault would."""
    firmware = rig()
    firmware.fault = True
    assert sample(firmware).status == FAULT
    firmware.receive(encode(frames.Arm(SESSION, firmware.number)))
    drive(firmware)
    assert firmware.code == 0
