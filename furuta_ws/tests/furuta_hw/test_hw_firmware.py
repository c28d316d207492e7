"""The reference firmware drives while it is answered; ``proofs`` explores when it must not."""

from pathlib import Path

import numpy as np
import pytest

from furuta_hw.emulator import running_rig
from furuta_hw.emulator.emulated_rig import EmulatedRig
from furuta_hw.emulator.firmware import Firmware
from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import ARMED, FAULT, WATCHDOG, FrameReader, encode
from furuta_hw.rigs.rig import Rig

SESSION = 77
WATCHDOG_SAMPLES = 5


def rig(armed: bool = True) -> Firmware:
    """Make a firmware in a session, armed and driven at code 100."""
    firmware = Firmware(-2048, 2047, 0)
    firmware.receive(encode(frames.HelloFrame(frames.VERSION, SESSION, 1000, WATCHDOG_SAMPLES)))
    sample(firmware)
    if armed:
        firmware.receive(encode(frames.ArmFrame(SESSION, firmware.number)))
        drive(firmware)
        assert firmware.code == 100
    return firmware


def sample(firmware: Firmware) -> frames.SensorsFrame:
    """Take a sample and return its frame."""
    *_, last = FrameReader().read(firmware.sample(0, 0, 0))
    assert isinstance(last, frames.SensorsFrame)
    return last


def drive(firmware: Firmware, code: int = 100) -> None:
    """Send a Drive frame for the newest sample."""
    firmware.receive(encode(frames.DriveFrame(SESSION, firmware.number, code)))


def test_watchdog_stops_a_silent_host() -> None:
    """The drive goes to 0 V after the watchdog's number of samples, until it is armed again."""
    firmware = rig()
    for k in range(1, WATCHDOG_SAMPLES + 1):
        status = sample(firmware)
        assert firmware.code == (100 if k < WATCHDOG_SAMPLES else 0)
        assert status.drive == 100  # applied up to this sample
    assert status.status == WATCHDOG
    drive(firmware)
    assert firmware.code == 0
    firmware.receive(encode(frames.ArmFrame(SESSION, firmware.number)))
    drive(firmware, 50)
    assert firmware.code == 50
    assert sample(firmware).status == ARMED


def test_host_of_another_version_gets_no_samples() -> None:
    """It receives the rig's version only."""
    firmware = rig()
    firmware.receive(encode(frames.HelloFrame(frames.VERSION + 1, 9, 1000, WATCHDOG_SAMPLES)))
    (welcome,) = FrameReader().read(firmware.sample(0, 0, 0))
    assert welcome == frames.WelcomeFrame(frames.VERSION, 9, 1000, WATCHDOG_SAMPLES)
    assert firmware.sample(0, 0, 0) == b""


def test_a_fault_of_the_rig_stops_it_and_prevents_arming() -> None:
    """For example an emergency stop or a fault of the amplifier."""
    firmware = rig()
    firmware.fault = True
    assert sample(firmware).status == FAULT
    firmware.receive(encode(frames.ArmFrame(SESSION, firmware.number)))
    drive(firmware)
    assert firmware.code == 0


def test_bytes_arrive_once_while_another_thread_takes_them() -> None:
    """The other thread runs while the emulated rig takes the second bytes."""
    taken: list[bytes] = []

    class Recorder(Firmware):
        def receive(self, data: bytes) -> None:
            taken.append(data)

    emulated = EmulatedRig(Rig(), make_firmware=Recorder)

    class Interrupted(bytes):
        def __radd__(self, before: bytes) -> bytes:
            emulated.process_input()
            return bytes(before) + bytes(self)

    emulated.receive(b"first")
    emulated.receive(Interrupted(b"second"))
    emulated.process_input()
    assert b"".join(taken) == b"firstsecond"


def test_the_log_keeps_the_newest_samples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In order, and no more than it has room for, however long the rig runs."""
    monkeypatch.setattr(running_rig, "KEPT", 10)
    running, file = running_rig.RunningRig(EmulatedRig(Rig()), 0.001), tmp_path / "log.npz"
    for newest in range(1, 26):
        running._sample(0)
        kept = running.answer({"do": "save", "path": str(file)})["rows"]
        assert kept == min(newest, 10)
        assert list(np.load(file)["sample"]) == list(range(newest - kept + 1, newest + 1))
