"""Safety: limits commands to a rig and stops it. A core without clock; times [s] are arguments.

An armed guard passes commands, limited in size and slew rate, until it detects a problem. Then it
disarms, and only :meth:`Guard.arm` arms it again.
"""

from math import exp, inf, isfinite

from furuta_hw.connection.rig_driver import RigSample
from furuta_hw.rigs.rig import SafetyLimits

# Time constant [s] over which bad frames and the disagreement of encoder and speed are counted.
WINDOW = 1.0
# Commands that are passed after a friction estimate: the second one can overtake its own estimate.
COMMANDS_PER_ESTIMATE = 2


class Guard:
    """Guards one rig with ``limits``, sampled every ``sample_time`` [s]."""

    def __init__(self, limits: SafetyLimits, sample_time: float) -> None:
        self.limits = limits
        self.sample_time = sample_time
        self._largest_step = limits.slew_rate * sample_time
        self.armed = False
        self.reason = "not armed yet"
        self.stops, self.is_stopped = 0, False  # stops since the start; none has been armed since
        self.voltage = 0.0
        self._measured_at = self._armed_at = -inf
        # Time of the first measurement that no command, or no friction estimate, has followed yet.
        self._command_due_since = self._estimate_due_since = inf
        self._commands_since_estimate = 0
        self._rig_was_armed = False  # the rig has reported that it is armed
        self._sample: RigSample | None = None
        self._bad_frames = 0.0
        self._disagreement = 0.0

    def measured(self, now: float, sample: RigSample) -> None:
        """Take note of a sample."""
        last = self._sample
        steps = (sample.number - last.number) % 2**32 if last else 0
        fade = exp(-steps * self.sample_time / WINDOW)
        self._bad_frames *= fade
        self._disagreement *= fade
        if last and steps:
            moved = sample.arm_angle - last.arm_angle
            difference = moved - sample.arm_speed * self.sample_time * steps
            # NaN would stay in the sum for good.
            self._disagreement += difference if isfinite(difference) else 0.0
        self._sample, self._measured_at = sample, now
        self._command_due_since = min(self._command_due_since, now)
        self._estimate_due_since = min(self._estimate_due_since, now)
        self._rig_was_armed = self._rig_was_armed or sample.armed
        self.check(now)

    def count_bad_frames(self, count: int) -> None:
        """Take note of frames lost or corrupt, in either direction."""
        self._bad_frames += count

    def estimated(self) -> None:
        """Take note of a friction estimate: the friction observer is alive."""
        self._estimate_due_since = inf
        self._commands_since_estimate = 0

    def command(self, now: float, u: float) -> float | None:
        """Return the voltage [V] to apply for the command ``u`` [V]; None to apply nothing."""
        if not isfinite(u):
            self.stop(f"command is {u}")
            return None
        self.check(now)
        self._command_due_since = inf
        self._commands_since_estimate += 1
        if not self.armed or self._is_observer_missing():
            return None
        u = min(max(u, -self.limits.voltage), self.limits.voltage)
        step = self._largest_step
        self.voltage = min(max(u, self.voltage - step), self.voltage + step)
        return self.voltage

    def _is_observer_missing(self) -> bool:
        """Whether commands come without estimates.

        They are withheld, so that the rig's watchdog counts from the last complete sample.
        """
        missing = self._commands_since_estimate > COMMANDS_PER_ESTIMATE
        return missing and isfinite(self.limits.estimate_age)

    def arm(self, now: float) -> str:
        """Arm; returns the reason if that is not possible, otherwise an empty string."""
        reason = self._problem(now)
        if reason:
            return reason
        self.armed, self.is_stopped, self.reason = True, False, ""
        self._rig_was_armed, self._armed_at = False, now
        self.voltage = 0.0
        return ""

    def disarm(self, reason: str) -> None:
        """Disarm, as somebody wishes. Only the first reason is kept."""
        self.voltage = 0.0
        if self.armed:
            self.armed, self.reason = False, reason

    def stop(self, reason: str) -> None:
        """Disarm because of a problem; this is counted."""
        if self.armed:
            self.stops, self.is_stopped = self.stops + 1, True
        self.disarm(reason)

    def check(self, now: float) -> None:
        """Stop if there is a problem; to be called at least every few milliseconds."""
        if self.armed:
            reason = self._problem(now) or self._disarmed_rig(now)
            if reason:
                self.stop(reason)

    def forget_samples(self) -> None:
        """Discard everything about earlier samples, because their numbers start again."""
        self._measured_at, self._sample = -inf, None
        self._command_due_since = self._estimate_due_since = inf
        self._bad_frames = self._disagreement = 0.0

    def _problem(self, now: float) -> str:
        """Return the reason why the rig must not be driven, or an empty string."""
        return self._stale_data(now) or self._bad_measurement() or self._reported_problem()

    def _stale_data(self, now: float) -> str:
        limits = self.limits
        if self._sample is None or now - self._measured_at > limits.measurement_age:
            return f"no measurement for {limits.measurement_age:g} s"
        if now - self._command_due_since > limits.command_age:
            return f"no command for {limits.command_age:g} s"
        if now - self._estimate_due_since > limits.estimate_age:
            return f"no friction estimate for {limits.estimate_age:g} s"
        return ""

    def _bad_measurement(self) -> str:
        limits, sample = self.limits, self._sample
        if sample is None or not isfinite(
            sample.arm_angle + sample.arm_speed + sample.pendulum_angle
        ):
            return "measurement is not finite"
        if sample.at_rail:
            return "a sensor is at the end of its range"
        for name, value, limit, unit in (
            ("pendulum angle", sample.pendulum_angle, limits.pendulum_angle, "rad"),
            ("arm angle", sample.arm_angle, limits.arm_angle, "rad"),
            ("arm speed", sample.arm_speed, limits.arm_speed, "rad/s"),
        ):
            if not abs(value) <= limit:
                return f"{name} {value:.3f} {unit} is beyond {limit:g} {unit}"
        if not abs(self._disagreement) <= limits.disagreement:
            return f"encoder and speed disagree by {self._disagreement:.3f} rad"
        return ""

    def _reported_problem(self) -> str:
        if not self._bad_frames * self.sample_time / WINDOW <= self.limits.bad_frames:
            return f"more than {self.limits.bad_frames:.0%} of the frames are lost or corrupt"
        return "the rig reports a fault" if self._sample and self._sample.fault else ""

    def _disarmed_rig(self, now: float) -> str:
        """Return why the rig is not armed although this guard is; empty if it is armed."""
        sample = self._sample
        if sample is None or sample.armed:
            return ""
        if self._rig_was_armed:
            return "the rig's watchdog stopped it" if sample.watchdog else "the rig stopped"
        if now - self._armed_at > self.limits.measurement_age:
            return "the rig did not arm"
        return ""
