"""From a frame of codes to a measurement, and the time stamps of the rig's samples."""

from __future__ import annotations

from math import exp, nan

import numpy as np

from furuta_hw.codes import wrapped
from furuta_hw.frames import Sensors
from furuta_hw.rig import Rig
from furuta_model.state import EFFORT, PHI, PHI_DOT, THETA

# Largest correction of the stamps, per time: far above a crystal's error, far below a jitter.
SLEW = 200e-6


class Sensing:
    """Turns codes into a measurement (5,): x, NaN where the rig has no sensor (θ̇), and the
    torque applied up to the sample [V].
    """

    def __init__(self, rig: Rig) -> None:
        self._arm, self._speed = rig.arm.channel, rig.speed.channel
        self._pendulum, self._drive = rig.pendulum.channel, rig.drive.channel
        self._tachometer = rig.speed.sensor == "tachometer"
        self._potentiometer = rig.pendulum.sensor == "potentiometer"
        self._decay = rig.speed.bandwidth * rig.line.sample_time
        self._dt = rig.line.sample_time
        self._last: Sensors | None = None
        self.x = np.array((0.0, 0.0, 0.0, nan, 0.0))
        self.steps = 0
        self.at_rail = False

    def take(self, codes: Sensors) -> np.ndarray:
        """The measurement (5,), overwritten by the next; ``steps`` samples after the last."""
        last, self._last = self._last, codes
        self.steps = (codes.sample - last.sample) % 2**32 if last else 0
        phi = self._arm.to_si(codes.arm)
        if self._tachometer:
            self.x[PHI_DOT] = self._speed.to_si(codes.speed)
        elif self.steps:
            difference = (phi - self.x[PHI]) / (self.steps * self._dt)
            share = 1.0 - exp(-self._decay * self.steps)
            self.x[PHI_DOT] += share * (difference - self.x[PHI_DOT])
        self.x[PHI] = phi
        self.x[THETA] = wrapped(self._pendulum.to_si(codes.pendulum))
        self.x[EFFORT] = self._drive.to_si(codes.drive)
        self.at_rail = (self._tachometer and self._speed.at_rail(codes.speed)) or (
            self._potentiometer and self._pendulum.at_rail(codes.pendulum)
        )
        return self.x


class Timeline:
    """Stamps: start plus whole periods, slewed after the host's clock.

    The rig's crystal runs off the host's clock by some 10⁻⁵. Each stamp is moved towards the
    time of arrival by at most :data:`SLEW` of a period, which follows the median arrival and
    leaves jitter out.
    """

    def __init__(self, period: int) -> None:
        self._period = period
        self._largest = max(1, round(SLEW * period))
        self._start: int | None = None

    def stamp(self, sample: int, now: int) -> int:
        """The stamp [ns] of a sample that arrived at ``now`` [ns]."""
        if self._start is None:
            self._start = now - sample * self._period
        error = now - self._start - sample * self._period
        self._start += min(max(error, -self._largest), self._largest)
        return self._start + sample * self._period
