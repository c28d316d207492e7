"""Trials of a tuning: compensations with their swing."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple

import numpy as np

from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.parameters import values
from furuta_model.state import PHI

NONE, RECOMMENDED, AS_IT_IS = "none", "recommended", "as it is"
# A presliding that is learned and not kept.
LEARNED = 0.0
LEFT = "left the guard"


class Compensation(NamedTuple):
    """The parameters of estimator, friction observer and controller."""

    estimator: EstimatorParameters
    observer: ObserverParameters
    controller: ControllerParameters

    def changes(self, since: Compensation) -> dict[str, dict[str, Any]]:
        """Values that differ from those of another one, by node."""
        nodes = "estimator", "friction_observer", "controller"
        return {
            node: {name: new for name, new in values(group).items() if new != values(old)[name]}
            for node, group, old in zip(nodes, self, since, strict=True)
        }


class Trial(NamedTuple):
    """A compensation, and the arm's swing [rad]; infinite outside the guard.

    ``scale`` is that of the bandwidth, ``lag`` [s] what is known of the drive, ``presliding`` [rad]
    is kept or :data:`LEARNED`. A trial that is ``given_up`` swung more than that.
    """

    name: str
    scale: float
    lag: float
    presliding: float
    compensation: Compensation
    swing: float = inf
    given_up: bool = False

    @property
    def title(self) -> str:
        """What is tried."""
        if self.name in (NONE, AS_IT_IS):
            return self.name
        kept = f", presliding {1e3 * self.presliding:.3g} mrad" if self.presliding else ""
        return f"{self.name}, bandwidth × {self.scale:.3g}, lag {1e3 * self.lag:.3g} ms{kept}"

    @property
    def remark(self) -> str:
        """Why it ended early, if so."""
        return LEFT if self.swing == inf else "given up" if self.given_up else ""

    def __str__(self) -> str:
        """A line of the report."""
        if self.swing == inf:
            return f"{self.title}: {LEFT}"
        return f"{self.title}: {'more than ' if self.given_up else ''}{self.swing:.4f} rad"


@dataclass(frozen=True)
class TuningResult:
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


def swing_of(estimates: list[np.ndarray]) -> float:
    """The arm's angle in all parts, peak to peak [rad]."""
    return float(np.ptp(np.concatenate([part[:, PHI] for part in estimates])))
