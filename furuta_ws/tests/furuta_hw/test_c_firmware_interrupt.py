"""The timer's interrupt at every instruction of the C firmware leaves no half-done state."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING, NamedTuple

import pytest
from firmware_schedules import Schedule

from furuta_hw.emulator.compiled_firmware import RECEIVE, SAMPLE, State, parse_log
from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import encode

if TYPE_CHECKING:
    from cortex_m import CortexM

SESSION = 77
WATCHDOG = 5


def script_before(frame: bytes, age: int) -> bytes:
    """A driven rig, ``age`` samples after its newest answer; the frame lacks its closing zero."""
    schedule = Schedule(Random(0))
    schedule.start_session(SESSION, WATCHDOG)
    schedule.send(frames.DriveFrame(SESSION, 1, 500))
    for _ in range(age):
        schedule.sample(1, 2, 3)
    schedule.receive(frame[:-1])
    return schedule.script


class Case(NamedTuple):
    """A frame that arrives so many samples after the last answer."""

    frame: bytes
    age: int


TRIPS = WATCHDOG - 1  # the interrupt then stops the rig, unless the frame came before it
CASES = {
    "drive": Case(encode(frames.DriveFrame(SESSION, 3, -700)), 2),
    "drive or trip": Case(encode(frames.DriveFrame(SESSION, 1 + TRIPS, -700)), TRIPS),
    "drive that gets old": Case(encode(frames.DriveFrame(SESSION, 2, -700)), TRIPS),
    "arm": Case(encode(frames.ArmFrame(SESSION, 3)), 2),
    "arm or trip": Case(encode(frames.ArmFrame(SESSION, 1 + TRIPS)), TRIPS),
    "stop": Case(encode(frames.StopFrame(SESSION)), 2),
    "hello": Case(encode(frames.HelloFrame(1, 9, 1000, 50)), 2),
    "damaged": Case(b"\1\2\3\0", 2),
}
TICK = SAMPLE.pack(b"s", 0, 1, 2, 3)
# The closing zero, and another one at which the firmware sends what it has.
END = RECEIVE.pack(b"r", 0, 1) + b"\0"


def outcome(log: bytes) -> tuple[State, bytes]:
    """The last state, and all that was sent."""
    entries = parse_log(log)
    return entries[-1][1], b"".join(out for out, _ in entries)


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_interrupt_at_every_instruction(stepping: CortexM, name: str) -> None:
    """State and bytes are those of the sample before the frame or of the sample after it.

    A sample that Hello overtakes belongs to no session any more and is not sent.
    """
    machine = stepping
    machine.replay(script_before(*CASES[name]))
    state = machine.state()
    allowed = []
    for script in (TICK + END, END + TICK):
        machine.restore(state)
        allowed.append(outcome(machine.replay(script + END)))
    if name == "hello":
        machine.restore(state)
        allowed.append((allowed[0][0], outcome(machine.replay(END))[1]))
    seen = []
    while True:
        machine.restore(state)
        interrupted, log = machine.replay_interrupted(len(seen) + 1, END)
        if not interrupted:
            break
        seen.append(outcome(log + machine.replay(END)))
        assert seen[-1] in allowed, len(seen)
    assert len(seen) > 100
    assert {allowed[0], allowed[1]} <= {*seen}
