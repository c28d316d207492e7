"""The C firmware sends the bytes of the reference and has its states, on every processor."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from firmware_schedules import Schedule, assert_same, random_schedules, schedule_of
from hypothesis import given, settings

from furuta_hw.emulator.compiled_firmware import POWER_ON, parse_log
from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import FrameReader, encode

Replays = dict[str, Callable[[bytes], bytes]]

PAGE = Path(__file__).resolve().parents[3] / "docs" / "hardware.md"
SESSION = 4660  # of the documentation's test vectors


@settings(max_examples=200, deadline=None)
@given(given=random_schedules())
def test_random_schedules(replays: Replays, given: Any) -> None:
    """Frames of every kind, damaged, repeated, late, of other sessions, beyond wrap-arounds."""
    schedule = schedule_of(*given)
    for log in {replay(schedule.script) for replay in replays.values()}:
        assert_same(schedule, log)


def vectors() -> dict[str, bytes]:
    """The test vectors of docs/hardware.md: text and bytes."""
    rows = re.findall(r"^\| `(\w+\([^`]*\))` \| `([0-9a-f ]+)` \|$", PAGE.read_text(), re.M)
    return {text: bytes.fromhex(data) for text, data in rows}


def vector_schedule() -> Schedule:
    """A schedule with every frame of the documentation's test vectors."""
    given = vectors()
    schedule = Schedule()
    schedule.receive(given["Hello(1, 4660, 1000, 50)"])
    for _ in range(7):
        schedule.sample()
    schedule.receive(given["Arm(4660, 7)"])
    schedule.sample()
    schedule.receive(given["Drive(4660, 8, -2048)"])
    schedule.send(frames.DriveFrame(SESSION, 8, 100))
    schedule.sample(-3, 17, -2048)
    schedule.set_numbers(256, 255)
    schedule.receive(given["Drive(4660, 256, 0)"])
    schedule.receive(b"\1\0" * 3)
    schedule.set_numbers(65535, 65486)
    schedule.sample(250, -1, 0)
    schedule.send(frames.ArmFrame(SESSION, 65536))
    schedule.receive(given["Stop(4660)"])
    schedule.sample()
    return schedule


def test_vectors_of_the_documentation(replays: Replays) -> None:
    """The host's frames are executed, and the rig's frames are sent to the last bit."""
    schedule = vector_schedule()
    for replay in replays.values():
        log = replay(schedule.script)
        assert_same(schedule, log)
        sent = b"".join(out for out, _ in parse_log(log))
        for text, data in vectors().items():
            if text.startswith(("Welcome", "Sensors")):
                assert data in sent, text
    # None of the host's vectors was discarded; the three damaged frames were.
    assert [step.state.discarded for step in schedule.steps][-1] == 3


def test_counters_wrap_around(replays: Replays) -> None:
    """Driven across sample 2³² without interruption; 2¹⁶ discarded frames count as none."""
    schedule = Schedule()
    schedule.start_session()
    schedule.set_numbers(2**32 - 10, 2**32 - 10)
    for _ in range(20):
        schedule.sample()
        schedule.send(frames.DriveFrame(77, schedule.firmware.number, 5))
    assert (schedule.firmware.driven, schedule.firmware.number) == (20, 10)
    for _ in range(5):
        schedule.receive(b"\1\0" * 14_000)
        schedule.sample()
    assert schedule.steps[-1].state.discarded == 70_000 - 2**16
    for replay in replays.values():
        assert_same(schedule, replay(schedule.script))


@pytest.mark.parametrize(
    ("asked", "offered"), [((1000, 50), (2000, 50)), ((90_000, 900), (20_000, 200))]
)
def test_a_board_offers_what_it_supports(
    replays: Replays, asked: tuple[int, int], offered: tuple[int, int]
) -> None:
    """The nearest period and watchdog within its limits, in Welcome and in its own state."""
    start = POWER_ON.pack(b"b", -100, 100, 0, 2000, 20_000, 200)
    hello = encode(frames.HelloFrame(1, SESSION, *asked))
    script = start + b"r\0" + len(hello).to_bytes(2, "little") + hello
    for replay in replays.values():
        (out, state) = parse_log(replay(script))[-1]
        (welcome,) = FrameReader().read(out)
        assert welcome == frames.WelcomeFrame(1, SESSION, *offered)
        assert (state.period_us, state.watchdog) == offered
