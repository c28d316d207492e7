"""A host that is killed at a random moment: the C firmware goes to 0 V within its watchdog."""

import os
import signal
from pathlib import Path
from random import Random
from time import monotonic, monotonic_ns, sleep
from typing import Any

import numpy as np
import pytest

from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import FrameReader, SensorsFrame, encode

pytestmark = [pytest.mark.realtime, pytest.mark.long]

KILLS = 5
PERIOD = 1_000_000  # [ns]
WATCHDOG = 50  # samples
CODE = 100


def drive_for_ever(port: Path, session: int) -> None:
    """Be a host: start a session, arm, and answer every sample."""
    line = os.open(port, os.O_RDWR | os.O_NOCTTY)
    os.write(line, b"\0" + encode(frames.HelloFrame(frames.VERSION, session, 1000, WATCHDOG)))
    reader = FrameReader()
    while True:
        for frame in reader.read(os.read(line, 4096)):
            if isinstance(frame, SensorsFrame) and frame.session == session:
                if not frame.status & frames.ARMED:
                    os.write(line, encode(frames.ArmFrame(session, frame.sample)))
                os.write(line, encode(frames.DriveFrame(session, frame.sample, CODE)))


def start_host(port: Path, session: int) -> int:
    """Start the host in a copy of this process; returns its id."""
    child = os.fork()
    if child == 0:
        try:
            drive_for_ever(port, session)
        finally:
            os._exit(1)
    return child


def wait_for(rig: Any, field: str, increase: int) -> None:
    """Return when a counter of the rig's status has increased by so much."""
    begun = rig.ask("status")[field]
    end = monotonic() + 120.0
    while rig.ask("status")[field] < begun + increase:
        assert monotonic() < end, f"{field} does not increase"
        sleep(0.002)


def kill(rig: Any, random: Random, session: int) -> tuple[int, int]:
    """Start a host and kill it at a random moment.

    Returns since when the host has been dead and until when it was watched [ns].
    """
    host = start_host(rig.port, session)
    try:
        wait_for(rig, "driven", 3)
        sleep(random.uniform(0.0, 0.01))
    finally:
        os.kill(host, signal.SIGKILL)
        os.waitpid(host, 0)
    dead = monotonic_ns()
    while monotonic_ns() < dead + (WATCHDOG + 10) * PERIOD:
        wait_for(rig, "sample", 1)
    return dead, monotonic_ns()


def test_killed_host(emulate: Any, tmp_path: Path) -> None:
    """Driven until the kill, and 0 V from the watchdog's time on."""
    pytest.importorskip("ziglang", reason="pip install -r firmware/requirements.lock")
    rig = emulate("--firmware")
    random = Random(4)
    kills = [kill(rig, random, session) for session in range(1, KILLS + 1)]
    log = rig.log(tmp_path / "log.npz")
    time, volts = log["time_ns"], log["volts"]
    driven = 0
    for dead, end in kills:
        after = volts[(time > dead + WATCHDOG * PERIOD) & (time < end)]
        assert np.all(after == 0.0)
        # On a loaded machine the host may be late, and the rig stopped before the kill, or the rig
        # is late and has no sample yet.
        before = volts[(time > dead - 2 * PERIOD) & (time < dead)]
        driven += bool(np.any(before != 0.0) and len(after) > 0)
    print(f"\n{driven} of {KILLS} kills while driven")
    assert driven > KILLS // 4
