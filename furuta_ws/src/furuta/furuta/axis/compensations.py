"""Compares friction compensations on an axis, and recommends one.

Each candidate knows the friction of the model, but the true friction is smaller or larger: what
suits one level only is no recommendation.
"""

from typing import NamedTuple

import numpy as np

from furuta.axis.axis import Axis, Controller, servo_cycle
from furuta.axis.sampled_loop import CANDIDATES
from furuta.axis.simulation import MOST_SAMPLES, simulate_axis
from furuta.limit_cycles.joint import JointCycle
from furuta_model.parameters import ParameterError

# True levels of friction, relative to those that the compensators assume.
LEVELS = (0.8, 1.0, 1.25)
# Length of a simulation in periods of the cycle, and its limits [s]; the last half is measured.
PERIODS = 20.0
SHORTEST, LONGEST = 10.0, 600.0
# An error above the smallest one that is as good: by this factor, or by half a count.
AS_GOOD = 1.1


class Residual(NamedTuple):
    """What remains with a compensation, the worst over the true levels of friction [rad]."""

    compensation: str
    error_rad: float
    peak_to_peak_rad: float


class AxisComparison(NamedTuple):
    """The residual of each candidate, and the recommended one: the simplest of the best."""

    residuals: tuple[Residual, ...]
    recommended: Residual


def compare_on_axis(
    axis: Axis,
    controller: Controller,
    *,
    speed: float = 0.0,
    counts: int = 4096,
    sample_time: float = 1e-3,
    cycle: JointCycle | None = None,
) -> AxisComparison:
    """Simulate an axis with each compensation, and recommend one.

    Args:
        axis: The axis as the compensators assume it; the true friction is 0.8, 1 and 1.25 times as
            large.
        controller: Its gains.
        speed: Speed of the reference [rad/s].
        counts: Counts of the encoder per turn; 0 for a perfect sensor.
        sample_time: Time between samples [s].
        cycle: The motion without compensation, if it is known.

    Raises:
        ParameterError: The axis is unstable without friction, or an argument is not allowed.
    """
    cycle = cycle or servo_cycle(axis, controller, speed)
    if cycle.kind == "unbounded":
        raise ParameterError("the axis is unbounded without compensation: change the gains")
    seconds = SHORTEST if np.isnan(cycle.period_s) else PERIODS * cycle.period_s
    seconds = min(max(seconds, SHORTEST), LONGEST, MOST_SAMPLES * sample_time)
    residuals = []
    for compensation in CANDIDATES:
        errors = []
        for level in LEVELS:
            record = simulate_axis(
                _with_level(axis, level),
                controller,
                seconds=seconds,
                reference=speed,
                compensation=compensation,
                model=axis,
                counts=counts,
                sample_time=sample_time,
            )
            errors.append(record.error[len(record.error) // 2 :])
        largest = float(np.max(np.abs(errors)))
        residuals.append(Residual(compensation, largest, float(np.max(np.ptp(errors, axis=1)))))
    best = min(residual.error_rad for residual in residuals)
    good = max(AS_GOOD * best, best + (np.pi / counts if counts else 0.0))
    return AxisComparison(tuple(residuals), next(r for r in residuals if r.error_rad <= good))


def _with_level(axis: Axis, factor: float) -> Axis:
    """The axis with larger or smaller levels of dry friction."""
    p = axis.friction
    return axis._replace(friction=p._replace(alpha0=factor * p.alpha0, alpha1=factor * p.alpha1))
