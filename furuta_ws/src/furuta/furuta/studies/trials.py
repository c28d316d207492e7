"""Trials of a tuning: compensations with their swing, and what the estimates of one show."""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple

import numpy as np

from furuta_control.control import ControllerParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import values
from furuta_model.state import OBSERVED_FRICTION, PHI, PHI_DOT

NONE, AS_IT_IS = "none", "as it is"
# Speed [rad/s], and part of the highest speed, from which the arm slides; samples that are enough.
SLIDING, FAST, ENOUGH = 0.05, 0.3, 100


class Compensation(NamedTuple):
    """The parameters of friction observer and controller."""

    observer: ObserverParameters
    controller: ControllerParameters

    def changes(self, since: Compensation) -> dict[str, dict[str, Any]]:
        """Values that differ from those of another one, by node."""
        named = {"friction_observer": self.observer, "controller": self.controller}
        return {
            node: {name: new for name, new in values(group).items() if new != values(old)[name]}
            for (node, group), old in zip(named.items(), since, strict=True)
        }


class Trial(NamedTuple):
    """A compensation with a scale, and the arm's swing [rad]; infinite outside the guard.

    A trial that is ``given_up`` swung more than that.
    """

    name: str
    scale: float
    compensation: Compensation
    swing: float = inf
    given_up: bool = False

    @property
    def is_inside(self) -> bool:
        """Whether it was neither given up nor outside the guard."""
        return self.swing < inf and not self.given_up

    def __str__(self) -> str:
        """A line of the report."""
        scale = "" if self.name in (NONE, AS_IT_IS) else f" {self.scale:.3g}"
        if self.swing == inf:
            return f"{self.name}{scale}: left the guard"
        return f"{self.name}{scale}: {'more than ' if self.given_up else ''}{self.swing:.4f} rad"

    def as_json(self) -> dict[str, Any]:
        """The trial as a JSON object."""
        return {
            "compensation": self.name,
            "scale": self.scale,
            "phi_peak_to_peak_rad": None if self.swing == inf else self.swing,
            "given_up": self.given_up,
        }


class TuningResult(NamedTuple):
    """The motion as it was and with the result, all trials, pendulum time [s], one count of the
    encoder [rad].
    """

    before: Trial
    after: Trial
    trials: list[Trial]
    seconds: float
    encoder_count: float

    @property
    def gain(self) -> bool:
        """Whether tuning found something better than what was."""
        return self.after.compensation != self.before.compensation

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """The values that tuning changed, by node."""
        return self.after.compensation.changes(self.before.compensation)

    def as_json(self) -> dict[str, Any]:
        """The result as a JSON object."""
        return {
            "parameters": self.parameters,
            "before": self.before.as_json(),
            "after": self.after.as_json(),
            "trials": [trial.as_json() for trial in self.trials],
            "gain": self.gain,
            "pendulum_seconds": self.seconds,
        }


def is_twisting(compensation: Compensation) -> bool:
    """Whether it is of the recommended kind: LuGre with super-twisting."""
    observer, controller = compensation
    return observer.compensation == "lugre" and controller.balance.super_twisting > 0.0


def swing_of(estimates: list[np.ndarray]) -> float:
    """The arm's angle in all parts, peak to peak [rad]."""
    return float(np.ptp(np.concatenate([part[:, PHI] for part in estimates])))


def observed_friction(estimates: np.ndarray, known: Friction) -> Friction:
    """The friction with the levels that ``estimates`` (n, 5) show where the arm slides.

    It is the one that was ``known`` if the arm does not slide in both directions, or if what the
    estimator observes does not oppose it, as behind an elastic coupling.
    """
    speed, friction = estimates[:, PHI_DOT], estimates[:, OBSERVED_FRICTION]
    slides = np.abs(speed) > max(SLIDING, FAST * np.max(np.abs(speed)))
    forward, backward = friction[slides & (speed > 0.0)], -friction[slides & (speed < 0.0)]
    if min(len(forward), len(backward)) < ENOUGH:
        return known
    high, low = float(np.mean(forward)), float(np.mean(backward))
    if not min(high, low) > 0.0:
        return known
    level = 0.5 * (high + low)
    factor = level / known.alpha0 if known.alpha0 else 1.0
    asymmetry = 0.5 * (high - low) / level
    return known._replace(alpha0=level, alpha1=factor * known.alpha1, asymmetry=asymmetry)
