"""A compensator of the user's own: a function F̂ = f(memory, x, p), called by its address."""

from typing import Any, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.friction.levels import copied
from furuta_model.friction.parameters import Friction
from furuta_model.own_functions import begin_own, call_own


class OwnCompensation(NamedTuple):
    """What an own compensator gets as ``p``."""

    friction: Friction = Friction()
    observer_gain: float = 0.0
    adaptation_gain: float = 0.0
    sample_time: float = 0.0


@inlined
def estimate(memory: Any, x: np.ndarray, p: Any) -> float:
    """F̂ [V] for the state estimate ``x`` (5,)."""
    rate = p.parts.adaptive.adaptation_gain
    given = OwnCompensation(copied(p.friction), p.observer_gain, rate, p.sample_time)
    begin_own(memory.own, p.function)
    return call_own(p.function, (memory.own.numbers, x, given))
