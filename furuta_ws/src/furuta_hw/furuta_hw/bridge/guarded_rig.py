"""A rig behind a guard, and the stamps of its samples: the core of the bridge, without ROS."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

from furuta_hw.connection.rig_connection import RigConnection
from furuta_hw.connection.rig_driver import RigSample
from furuta_hw.errors import LineError
from furuta_hw.guard import Guard
from furuta_ros.time_stamps import NANOSECONDS

# Largest correction of the stamps per period: far above a crystal's error, far below the jitter.
SLEW = 200e-6
# The rig counts its samples modulo this.
COUNTED = 2**32


class GuardedRig:
    """Passes commands to an open connection as far as the guard permits, and stops the rig.

    ``report_end`` is called once after every stop and each disarming, when the rig has been told.
    """

    def __init__(
        self, connection: RigConnection, guard: Guard, report_end: Callable[[], None]
    ) -> None:
        self.connection = connection
        self.guard = guard
        self._report_end = report_end
        self._was_armed = guard.armed
        self._restart_clock()

    def samples(self) -> Iterator[RigSample]:
        """Yield the new samples after the guard has checked each of them."""
        samples: list[RigSample] = []
        with self._stopped_on_failure():
            samples = self.connection.samples()
        for sample in samples:
            self.guard.count_bad_frames(self.connection.new_bad_frames())
            self.guard.measured(monotonic(), sample)
            self._handle_stop()
            if sample.armed and not self.guard.armed:
                self.connection.stop()
            yield sample

    def command(self, u: float) -> None:
        """Apply a command [V] within the guard's limits."""
        volts = self.guard.command(monotonic(), u)
        self._handle_stop()
        if volts is not None:
            with self._stopped_on_failure():
                self.connection.drive(volts)

    def arm(self) -> str:
        """Arm the rig; returns the reason if that is not possible, otherwise an empty string."""
        if self.guard.armed:
            return ""
        if not self.connection.connected:
            return f"no line to the rig: {self.connection.failure}"
        reason = self.guard.arm(monotonic())
        if not reason:
            with self._stopped_on_failure():
                self.connection.arm()
            reason = self.guard.reason
        self._was_armed = self.guard.armed
        return reason

    def stop(self, reason: str) -> None:
        """Disarm the guard and the rig, which goes to 0 V, because of a problem."""
        self.guard.stop(reason)
        self._handle_stop()
        self.connection.stop()

    def disarm(self, reason: str) -> None:
        """Disarm the guard and the rig, which goes to 0 V, as somebody wishes."""
        self.guard.disarm(reason)
        self._handle_stop()
        self.connection.stop()

    def check(self) -> None:
        """Stop the rig if commands or measurements are too old."""
        self.guard.check(monotonic())
        self._handle_stop()

    def close(self) -> None:
        """Stop the rig and close the line."""
        self.disarm("the bridge ends")
        self.connection.close()

    def _handle_stop(self) -> None:
        if self._was_armed and not self.guard.armed:
            self._was_armed = False
            self.connection.stop()
            self._report_end()

    @contextmanager
    def _stopped_on_failure(self) -> Iterator[None]:
        """Stop if the line fails. The connection recovers by itself; its samples start again."""
        try:
            yield
        except LineError as error:
            self.guard.stop(str(error))
            self._handle_stop()
            self.guard.forget_samples()
            self._restart_clock()

    def _restart_clock(self) -> None:
        """Begin to stamp samples, because their numbers start again."""
        self.clock = SampleClock(round(self.guard.sample_time * NANOSECONDS))


class SampleClock:
    """Stamps samples with start time plus whole periods, slowly corrected to the host's clock.

    The rig's crystal differs from the host's clock by about 10⁻⁵. Each stamp is moved towards the
    time of arrival by at most :data:`SLEW` of a period. This follows the median time of arrival
    and suppresses the jitter.
    """

    def __init__(self, period: int) -> None:
        self._period = period
        self._largest = max(1, round(SLEW * period))
        self._sample: int | None = None
        self._stamp = 0

    def stamp(self, sample: int, now: int) -> int:
        """Compute the stamp [ns] of a sample, by its number, that arrived at ``now`` [ns]."""
        if self._sample is None:
            self._sample, self._stamp = sample, now
        steps = (sample - self._sample + COUNTED // 2) % COUNTED - COUNTED // 2
        self._sample, due = sample, self._stamp + steps * self._period
        self._stamp = due + min(max(now - due, -self._largest), self._largest)
        return self._stamp
