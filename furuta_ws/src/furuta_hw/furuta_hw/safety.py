"""What stands between commands and a motor: a core without clock; times [s] come from outside.

Armed, a guard lets commands through, limited in size and slew, for as long as nothing is wrong.
The first thing that is wrong disarms it, and only :meth:`Guard.arm` arms it again.
"""

from __future__ import annotations

from math import exp, inf, isfinite

import numpy as np

from furuta_hw.frames import ARMED, FAULT, WATCHDOG
from furuta_hw.rig import Limits
from furuta_model.state import PHI, PHI_DOT, THETA

# Time [s] over which bad frames and disagreement of encoder and tachometer are counted.
WINDOW = 1.0
# Commands that may come since the last friction estimate: one of them can overtake its own.
OVERTAKEN = 2


class Guard:
    """Guards one rig with ``limits``, sampled every ``sample_time`` [s]."""

    def __init__(self, limits: Limits, sample_time: float) -> None:
        self.limits = limits
        self._dt = sample_time
        self._step = limits.slew_rate * sample_time
        self.armed = False
        self.reason = "not armed yet"
        self.stops = 0
        self.voltage = 0.0
        self._measured_at = self._armed_at = -inf
        # When the first measurement came that has no command, no friction estimate, since.
        self._command_asked = self._estimate_asked = inf
        self._without_estimate = 0
        self._obeyed = False  # the rig has said that it is armed
        self._status = 0
        self._x: np.ndarray | None = None
        self._at_rail = False
        self._bad = 0.0
        self._drift = 0.0

    def measured(self, now: float, x: np.ndarray, at_rail: bool, status: int, steps: int) -> None:
        """Take a measurement ``x`` (4 or more), ``steps`` samples after the last, and a status."""
        self._age(steps)
        if self._x is not None and steps:
            self._drift += x[PHI] - self._x[PHI] - x[PHI_DOT] * self._dt * steps
        self._x = x.copy()
        self._measured_at, self._at_rail, self._status = now, at_rail, status
        self._command_asked = min(self._command_asked, now)
        self._estimate_asked = min(self._estimate_asked, now)
        self._obeyed = self._obeyed or bool(status & ARMED)
        self.check(now)

    def line(self, bad: int) -> None:
        """Take note of frames lost or corrupt, on either way."""
        self._bad += bad

    def estimated(self) -> None:
        """Take note of a friction estimate: whoever makes them is alive."""
        self._estimate_asked = inf
        self._without_estimate = 0

    def command(self, now: float, u: float) -> float | None:
        """The voltage [V] to apply for the command ``u`` [V]; None where there is none to apply."""
        if not isfinite(u):
            self.stop(f"command is {u}")
            return None
        self.check(now)
        self._command_asked = inf
        self._without_estimate += 1
        # Kept back, so that the rig's watchdog counts from the last sample of a whole loop.
        partial = self._without_estimate > OVERTAKEN and isfinite(self.limits.estimate_age)
        if not self.armed or partial:
            return None
        u = min(max(u, -self.limits.voltage), self.limits.voltage)
        self.voltage = min(max(u, self.voltage - self._step), self.voltage + self._step)
        return self.voltage

    def arm(self, now: float) -> str:
        """Arm; returns the reason if that cannot be, and "" if it could."""
        reason = self._trouble(now)
        if reason:
            return reason
        self.armed, self.reason = True, ""
        self._obeyed, self._armed_at = False, now
        self.voltage = 0.0
        return ""

    def stop(self, reason: str) -> None:
        """Disarm, and keep the first reason."""
        self.voltage = 0.0
        if self.armed:
            self.armed, self.reason = False, reason
            self.stops += 1

    def check(self, now: float) -> None:
        """Stop if anything is wrong; to be called at least every few milliseconds."""
        if self.armed:
            reason = self._trouble(now) or self._disobedience(now)
            if reason:
                self.stop(reason)

    def forget(self) -> None:
        """Begin anew with a new line: no measurement yet."""
        self._measured_at, self._x, self._status = -inf, None, 0
        self._command_asked = self._estimate_asked = inf
        self._bad = self._drift = 0.0

    def _trouble(self, now: float) -> str:
        """What is wrong, "" for nothing."""
        return self._stale(now) or self._sensed() or self._reported()

    def _stale(self, now: float) -> str:
        limits = self.limits
        if self._x is None or now - self._measured_at > limits.measurement_age:
            return f"no measurement for {limits.measurement_age:g} s"
        if now - self._command_asked > limits.command_age:
            return f"no command for {limits.command_age:g} s"
        if now - self._estimate_asked > limits.estimate_age:
            return f"no friction estimate for {limits.estimate_age:g} s"
        return ""

    def _sensed(self) -> str:
        limits, x = self.limits, self._x
        if x is None or not isfinite(x[PHI] + x[PHI_DOT] + x[THETA]):
            return "measurement is not finite"
        if self._at_rail:
            return "a sensor is at the end of its range"
        for name, value, limit, unit in (
            ("pendulum angle", x[THETA], limits.pendulum_angle, "rad"),
            ("arm angle", x[PHI], limits.arm_angle, "rad"),
            ("arm speed", x[PHI_DOT], limits.arm_speed, "rad/s"),
        ):
            if abs(value) > limit:
                return f"{name} {value:.3f} {unit} is beyond {limit:g} {unit}"
        if abs(self._drift) > limits.disagreement:
            return f"encoder and speed disagree by {self._drift:.3f} rad"
        return ""

    def _reported(self) -> str:
        if self._bad * self._dt / WINDOW > self.limits.bad_frames:
            return f"more than {self.limits.bad_frames:.0%} of the frames are lost or corrupt"
        return "the rig reports a fault" if self._status & FAULT else ""

    def _disobedience(self, now: float) -> str:
        """Whether the rig, armed by us, is not or no longer armed."""
        if self._status & ARMED:
            return ""
        if self._obeyed:
            return "the rig's watchdog stopped it" if self._status & WATCHDOG else "the rig stopped"
        if now - self._armed_at > self.limits.measurement_age:
            return "the rig did not arm"
        return ""

    def _age(self, steps: int) -> None:
        fade = exp(-steps * self._dt / WINDOW)
        self._bad *= fade
        self._drift *= fade
