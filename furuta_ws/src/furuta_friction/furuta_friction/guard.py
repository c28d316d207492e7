r"""Switches a compensation off that is worse than none.

A compensation is worse than none if its error is larger than the friction itself. By power that is

.. math:: \overline{\hat F v} > 2\,\overline{F_o v}

F_o is the friction that the estimator observes, and the means are over about a second. F̂ then gives
the arm more than twice the power that friction takes: the arm is driven by its compensation. The
guard acts after this has lasted for the guard time while the arm slides. Without observed friction
(NaN) it cannot judge.

A compensation is also worse than none if F̂ vibrates because it follows the observed friction of an
elastic arm: observer and arm drive each other. The guard then reduces it at once
(:mod:`furuta_model.vibration`). While F̂ vibrates the powers are judged anew, whatever it follows:
the observed friction of a vibrating arm says nothing.
"""

from dataclasses import dataclass, field
from math import ceil, expm1, isnan
from typing import NamedTuple

import numpy as np

from furuta_model import vibration
from furuta_model.compiled import inlined
from furuta_model.state import OBSERVED_FRICTION, PHI_DOT, THETA
from furuta_model.vibration import (
    Vibration,
    VibrationMemory,
    is_sustained,
    part_without_vibration,
)

# Time constant of the means [s].
MEAN_TIME = 1.0
# Power of the compensation relative to that of friction from which it is worse than none.
WORST_RATIO = 2.0
# Mean speed [rad/s] above which the arm slides. Below it, noise would decide.
SLIDING_SPEED = 0.05
# Pendulum angle [rad] beyond which the estimator's linear model does not observe friction.
LARGEST_TILT = 0.5
# Amplitude of a vibration of F̂ relative to the highest level from which it is reduced.
VIBRATION = 0.5


@dataclass
class GuardMemory:
    """What the guard remembers.

    Attributes:
        given: Mean of F̂v, the power that the compensation gives [V rad/s].
        taken: Mean of F_o v, the power that friction takes [V rad/s].
        speed: Mean of |v| [rad/s].
        worse: Samples for which the compensation has been worse than none.
        vibration: Vibration of F̂.
        tripped: Whether it has been switched off.
    """

    given: float = 0.0
    taken: float = 0.0
    speed: float = 0.0
    worse: int = 0
    vibration: VibrationMemory = field(default_factory=VibrationMemory)
    tripped: bool = False


class Guard(NamedTuple):
    """The sampled guard: samples until it acts (0 for never), share of a new value in a mean.

    ``least_part`` is what a vibration of F̂ leaves of it at least, 1 if it does not reduce it.
    """

    patience: float
    share: float
    least_part: float
    vibration: Vibration


def design(guard_time: float, level: float, reduces: bool, dt: float) -> Guard:
    """The guard for the sample time ``dt`` [s] and the highest ``level`` of friction [V].

    An infinite level is for a compensation that jumps by design: its vibration is ignored.
    """
    return Guard(
        patience=ceil(guard_time / dt),
        share=-expm1(-dt / MEAN_TIME),
        least_part=0.0 if reduces else 1.0,
        vibration=vibration.design(VIBRATION * level, dt),
    )


@inlined
def guarded(memory: GuardMemory, x: np.ndarray, friction: float, p: Guard) -> float:
    """The friction estimate ``friction`` [V], or 0 V if the guard has switched it off.

    ``x`` (5,) is the state estimate.
    """
    if p.patience == 0.0:
        return friction
    if memory.tripped:
        return 0.0
    part = part_without_vibration(memory.vibration, friction, p.vibration)
    friction *= max(part, p.least_part)
    v, observed = x[PHI_DOT], x[OBSERVED_FRICTION]
    if isnan(observed) or not abs(x[THETA]) < LARGEST_TILT or is_sustained(memory.vibration):
        judge_anew(memory)
        return friction
    memory.given += p.share * (friction * v - memory.given)
    memory.taken += p.share * (observed * v - memory.taken)
    memory.speed += p.share * (abs(v) - memory.speed)
    slides = memory.speed > SLIDING_SPEED
    worse = slides and memory.given > WORST_RATIO * max(memory.taken, 0.0)
    memory.worse = memory.worse + 1 if worse else 0
    if memory.worse > p.patience:
        memory.tripped = True
    return friction


@inlined
def judge_anew(memory: GuardMemory) -> None:
    """Forget the powers."""
    memory.given = memory.taken = memory.speed = 0.0
    memory.worse = 0


@inlined
def forget(memory: GuardMemory) -> None:
    """Judge anew, and allow a compensation that was switched off or reduced."""
    judge_anew(memory)
    memory.tripped = False
    memory.vibration.part = 1.0
