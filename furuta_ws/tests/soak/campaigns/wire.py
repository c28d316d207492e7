"""Campaign ``wire``: damaged bytes between the protocol's host and the emulated rig.

Host, guard and rig run in one thread, sample by sample, without waiting: thousands of frames per
second. The time of the guard is that of the samples.
"""

import os
from math import inf, nan

import numpy as np

from furuta_control.control import ControllerParameters
from furuta_hw.drivers.serial_protocol.conversion import SampleConverter
from furuta_hw.drivers.serial_protocol.host import ProtocolHost
from furuta_hw.guard import Guard
from furuta_hw.rigs.rig import Rig
from furuta_sim.emulator.emulated_rig import EmulatedRig, plant_of
from furuta_sim.plant import design_plant
from soak.damaged_line import DamagedLine
from soak.mutators import pick
from soak.oracles import (
    armed_without_request,
    different_motion,
    late_stop,
    out_of_bounds,
    unarmed_drive,
)
from soak.record import Record
from soak.resources import ResourceMonitor

RIG = Rig()
PERIOD = RIG.line.sample_time
# Samples of a run, and how often the damage changes within it.
SAMPLES, EPISODE = 4_000, 400
# Damaged fraction of the frames, by episode. The largest ones stop the rig.
DAMAGED = (0.0, 0.02, 0.1, 0.5, 1.0)
# Fraction of the commands that are wild.
WILD = 0.002
GAIN = ControllerParameters().feedback_gain


class Loop:
    """Host, guard and emulated rig, one sample at a time."""

    def __init__(self, record: Record, random: np.random.Generator) -> None:
        self._record, self._random = record, random
        self.plant = plant_of(RIG, seed=int(random.integers(2**31)))
        self.rig = EmulatedRig(RIG, self.plant)
        self.line = DamagedLine(self.rig, record, random)
        self._guard = Guard(RIG.limits, PERIOD)
        self._bad = 0
        self.requests = 0
        self.log: list[tuple[float, ...]] = []
        self.now = 0.0
        self._connect()

    def _connect(self) -> None:
        """A new session; the host keeps trying while the line is damaged."""
        self._host = ProtocolHost(self.line, RIG)
        self._converter = SampleConverter(RIG)
        self._guard.forget_samples()
        self._bad = 0
        self._host.start_session()

    def step(self, silent: bool) -> None:
        """One sample; a silent host does not answer."""
        self.now += PERIOD
        out = self.line.carry(self.rig.step(), "to host")
        firmware = self.rig.firmware
        row = (self.now * 1e9, *self.rig.x[:4], self.rig.volts, float(firmware.armed))
        self.log.append(row)
        if silent:
            return
        self._receive(out)
        self._guard.check(self.now)
        if not self._guard.armed and self._random.random() < 0.02:
            self._arm()

    def _receive(self, out: bytes) -> None:
        before = self._host.sample
        frames = self._host.receive(out)
        numbers = [frame.sample for frame in frames]
        in_order = all(a < b for a, b in zip([before, *numbers], numbers, strict=False))
        self._record.check("frames", "" if in_order else f"samples {numbers} after {before}")
        for frame in frames:
            bad = self._host.statistics().bad
            self._guard.count_bad_frames(bad - self._bad)
            self._bad = bad
            sample = self._converter.convert(frame)
            self._guard.measured(self.now, sample)
            self._guard.estimated()
            if sample.armed and not self._guard.armed:
                self._host.stop()
            volts = self._guard.command(self.now, self._command())
            if volts is not None:
                self._host.drive(RIG.drive.channel.to_code(volts))

    def _command(self) -> float:
        """State feedback on the true state, and sometimes anything else."""
        if self._random.random() < WILD:
            return float(pick(self._random, (10.0, -10.0, 1e300, -1e300, nan, inf)))
        return -float(np.dot(GAIN, self.rig.x[:4]))

    def _arm(self) -> None:
        """Arm, after a new session or with the old one."""
        if self._random.random() < 0.5:
            self.rig.hold()
            self._connect()
        if not self._guard.arm(self.now):
            self.requests += 1
            self._host.arm()


def run(record: Record, watch: ResourceMonitor) -> None:
    """Run the slice."""
    random = record.part.random()
    plant = design_plant(plant_of(RIG))
    while record.next_step():
        loop, silences = _run(record, random)
        log = np.array(loop.log)
        time, states, volts, armed = log[:, 0], log[:, 1:5], log[:, 5], log[:, 6]
        record.tried["armed"] += loop.requests
        record.tried["driven samples"] += int(np.sum(volts != 0.0))
        record.check("unarmed", unarmed_drive(volts, armed, loop.requests))
        record.check("arming", armed_without_request(armed, loop.requests))
        record.check("bounds", out_of_bounds(states))
        record.check("rig = simulation", different_motion(states, volts, plant, loop.plant))
        for silent, back in silences:
            allowed = (RIG.watchdog_samples + 1) * PERIOD * 1e9
            record.check("watchdog", late_stop(time, volts, silent, back, allowed))
        watch.sample({"wire": os.getpid()})


def _run(record: Record, random: np.random.Generator) -> tuple[Loop, list[tuple[float, float]]]:
    """One run with episodes of damage; returns the times [ns] at which the host was silent."""
    loop = Loop(record, random)
    silences = []
    for episode in range(SAMPLES // EPISODE):
        loop.line.damaged = 0.0 if episode == 0 else float(pick(random, DAMAGED))
        silent_from = int(random.integers(EPISODE)) if random.random() < 0.5 else EPISODE
        begun = loop.now * 1e9
        for k in range(EPISODE):
            if k == silent_from:
                begun = loop.now * 1e9
            loop.step(silent=k >= silent_from)
        if silent_from < EPISODE:
            silences.append((begun, loop.now * 1e9))
    return loop, silences
