r"""Switches a compensation off that is worse than none.

A compensation is worse than none if its error is larger than the friction itself. By power that is

.. math:: \overline{\hat F v} > 2\,\overline{F_o v}

F_o is the friction that the estimator observes, and the means are over about a second. F̂ then gives
the arm more than twice the power that friction takes: the arm is driven by its compensation. The
guard acts after this has lasted for the guard time while the arm slides. Without observed friction
(NaN) it cannot judge.
"""

from __future__ import annotations

from math import ceil, expm1, isnan
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.state import OBSERVED_FRICTION, PHI_DOT, THETA

# Time constant of the means [s].
MEAN_TIME = 1.0
# Power of the compensation relative to that of friction from which it is worse than none.
WORST_RATIO = 2.0
# Mean speed [rad/s] above which the arm slides. Below it, noise would decide.
SLIDING_SPEED = 0.05
# Pendulum angle [rad] beyond which the estimator's linear model does not observe friction.
LARGEST_TILT = 0.5

# Indices in the guard's memory: means of F̂v and F_o v [V rad/s] and of |v| [rad/s]; samples for
# which the compensation has been worse than none; 1 once it has been switched off.
GIVEN, TAKEN, SPEED, WORSE, TRIPPED = range(5)
MEMORY = 5


class Guard(NamedTuple):
    """The sampled guard: samples until it acts (0 for never), share of a new value in a mean."""

    patience: float
    share: float


def design(guard_time: float, dt: float) -> Guard:
    """The guard for the sample time ``dt`` [s]."""
    return Guard(ceil(guard_time / dt), -expm1(-dt / MEAN_TIME))


@inlined
def guarded(memory: np.ndarray, at: int, estimate: np.ndarray, friction: float, p: Guard) -> float:
    """The friction estimate ``friction`` [V], or 0 V if the guard has switched it off.

    The guard's memory begins at ``at``; ``estimate`` (5,) is the state estimate.
    """
    if p.patience == 0.0:
        return friction
    if memory[at + TRIPPED] != 0.0:
        return 0.0
    v, observed = estimate[PHI_DOT], estimate[OBSERVED_FRICTION]
    if isnan(observed) or not abs(estimate[THETA]) < LARGEST_TILT:
        forget(memory, at)
        return friction
    memory[at + GIVEN] += p.share * (friction * v - memory[at + GIVEN])
    memory[at + TAKEN] += p.share * (observed * v - memory[at + TAKEN])
    memory[at + SPEED] += p.share * (abs(v) - memory[at + SPEED])
    worse = memory[at + SPEED] > SLIDING_SPEED and memory[at + GIVEN] > WORST_RATIO * max(
        memory[at + TAKEN], 0.0
    )
    memory[at + WORSE] = memory[at + WORSE] + 1.0 if worse else 0.0
    if memory[at + WORSE] > p.patience:
        memory[at + TRIPPED] = 1.0
    return friction


@inlined
def forget(memory: np.ndarray, at: int) -> None:
    """Judge anew, and allow a compensation that was switched off."""
    for i in range(MEMORY):
        memory[at + i] = 0.0
