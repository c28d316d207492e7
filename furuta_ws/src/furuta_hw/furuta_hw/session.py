"""A rig for commissioning, without ROS: read it, or drive it under the guard."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from math import inf, pi
from time import monotonic
from typing import TypeVar

import numpy as np

from furuta_hw.backend import open_backend
from furuta_hw.errors import LineError, StoppedError
from furuta_hw.frames import Sensors
from furuta_hw.host import Host
from furuta_hw.rig import Rig
from furuta_hw.safety import Guard
from furuta_hw.sensing import Sensing

# Longest wait for the rig's answer, and for a sample [s].
CONNECT = 3.0
SILENCE = 0.5

Result = TypeVar("Result")
# What drives a rig: it is sent measurements (5,) and yields voltages [V].
Experiment = Generator[float, np.ndarray, Result]


class Session:
    """An open line to a rig; a context manager that leaves it at 0 V."""

    def __init__(self, port: str, rig: Rig) -> None:
        self.rig = rig
        self._backend = open_backend(port, rig)
        self.host = Host(self._backend, rig)

    def __enter__(self) -> Session:
        try:
            self.host.connect(CONNECT)
        except LineError:
            self._backend.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self.host.stop()
        finally:
            self._backend.close()

    def samples(self, seconds: float = float("inf")) -> Iterator[Sensors]:
        """Samples as they come, for ``seconds`` of the rig's time."""
        left = seconds / self.rig.line.sample_time
        heard = monotonic()
        while left > 0:
            for sensors in self.host.receive(self._backend.read()):
                heard = monotonic()
                if left > 0:
                    left -= 1
                    yield sensors
            if monotonic() - heard > SILENCE:
                raise LineError(f"no sample for {SILENCE:g} s")

    def drive(self, experiment: Experiment[Result], voltage: float, travel: float) -> Result:
        """Run an experiment from where the arm is, within ±``travel`` [rad] and ±``voltage`` [V].

        Where the pendulum is does not matter. Raises :class:`StoppedError`.
        """
        samples = self.samples()
        first = next(samples)
        rig = self.rig._replace(arm=self.rig.arm._replace(zero=float(first.arm)))
        limits = rig.limits._replace(
            voltage=voltage, arm_angle=travel, pendulum_angle=pi, estimate_age=inf
        )
        guard, sensing, channel = (
            Guard(limits, rig.line.sample_time),
            Sensing(rig),
            rig.drive.channel,
        )
        volts, bad = next(experiment), self.host.bad
        try:
            for sensors in samples:
                x, now = sensing.take(sensors), monotonic()
                guard.line(self.host.bad - bad)
                bad = self.host.bad
                if not guard.armed:
                    self._arm(guard, now, x, sensors, sensing.steps)
                guard.measured(now, x, False, sensors.status, sensing.steps)
                applied = guard.command(now, volts)
                if applied is None:
                    raise StoppedError(guard.reason)
                self.host.drive(channel.to_code(applied))
                volts = experiment.send(x)
        except StopIteration as done:
            result: Result = done.value
            return result
        finally:
            self.host.stop()
        raise AssertionError("samples() never ends")

    def _arm(self, guard: Guard, now: float, x: np.ndarray, sensors: Sensors, steps: int) -> None:
        if guard.stops:
            raise StoppedError(guard.reason)
        guard.measured(now, x, False, sensors.status, steps)
        guard.command(now, 0.0)
        reason = guard.arm(now)
        if reason:
            raise StoppedError(reason)
        self.host.arm()
