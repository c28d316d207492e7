"""A session of commissioning: read a rig, or drive it under the guard, without ROS."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from math import inf, pi
from time import monotonic
from typing import TypeVar

from furuta_hw.connection.rig_driver import LineStatistics, RigSample
from furuta_hw.drivers import make_driver
from furuta_hw.errors import LineError, RigError, driver_errors
from furuta_hw.guard import Guard
from furuta_hw.rigs.rig import Rig

# Shortest time without a sample after which the line counts as failed [s].
SILENCE = 0.5
# Time at the largest voltage within which the arm must move [s].
PATIENCE = 1.0

Result = TypeVar("Result")
# An experiment drives a rig: it is sent samples, yields voltages [V] and returns its result. The
# arm angle of its samples is zero where the experiment starts.
Experiment = Generator[float, RigSample, Result]


def ramp(rate: float, voltage: float, sample_time: float) -> Iterator[float]:
    """Voltages [V] of the samples of a ramp by ``rate`` [V/s] until the arm moves.

    Raises :class:`RigError` after :data:`PATIENCE` at ``voltage`` [V].
    """
    u, samples = 0.0, 0
    while samples * sample_time < PATIENCE:
        u = min(u + rate * sample_time, voltage)
        samples += u == voltage
        yield u
    raise RigError(f"the arm did not move at {voltage:g} V; raise --voltage or check the motor")


class RigSession:
    """An open line to a rig; a context manager that leaves the rig at 0 V."""

    def __init__(self, port: str, rig: Rig) -> None:
        self.rig = rig
        self._driver = make_driver(port, rig)

    def __enter__(self) -> RigSession:
        with driver_errors():
            self._driver.open()
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self._driver.stop()
        finally:
            self._driver.close()

    def statistics(self) -> LineStatistics:
        """Return the frames counted so far."""
        return self._driver.statistics()

    def samples(self, seconds: float = inf) -> Iterator[RigSample]:
        """Yield samples as they come, for ``seconds`` of the rig's time."""
        left = seconds / self.rig.line.sample_time
        silence = max(SILENCE, self.rig.limits.measurement_age)
        received_at = monotonic()
        while left > 0:
            with driver_errors():
                samples = self._driver.decode(self._driver.read())
            for sample in samples:
                received_at = monotonic()
                if left > 0:
                    left -= 1
                    yield sample
            if monotonic() - received_at > silence:
                raise LineError(f"no sample for {silence:g} s")

    def drive(self, experiment: Experiment[Result], voltage: float, arm_range: float) -> Result:
        """Run an experiment within ±``voltage`` [V] and ±``arm_range`` [rad] of where the arm is.

        The angle of the pendulum is not limited. Raises :class:`RigError`.
        """
        samples = self._samples_from_here()
        limits = self.rig.limits._replace(
            voltage=voltage, arm_angle=arm_range, pendulum_angle=pi, estimate_age=inf
        )
        guard = Guard(limits, self.rig.line.sample_time)
        volts, bad_frames = next(experiment), self.statistics().bad
        try:
            for sample in samples:
                guard.count_bad_frames(self.statistics().bad - bad_frames)
                bad_frames = self.statistics().bad
                now = monotonic()
                guard.measured(now, sample)
                if not guard.armed:
                    self._arm(guard, now)
                applied = guard.command(now, volts)
                if applied is None:
                    raise RigError(guard.reason)
                with driver_errors():
                    self._driver.drive(applied)
                volts = experiment.send(sample)
        except StopIteration as done:
            result: Result = done.value
            return result
        finally:
            self._driver.stop()
        raise AssertionError("samples() never ends")

    def _samples_from_here(self) -> Iterator[RigSample]:
        """Yield samples whose arm angle is zero at the first one, which is left out.

        The hanging pendulum may be outside its sensor's range, so that is not reported.
        """
        samples = self.samples()
        start = next(samples).arm_angle
        for sample in samples:
            yield sample._replace(arm_angle=sample.arm_angle - start, at_rail=False)

    def _arm(self, guard: Guard, now: float) -> None:
        reason = guard.reason if guard.stops else guard.arm(now)
        if reason:
            raise RigError(reason)
        self._driver.arm()
