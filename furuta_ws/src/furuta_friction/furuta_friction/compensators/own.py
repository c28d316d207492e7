"""A compensator of the user's own: a function F̂ = f(memory, x, p), called by its address."""

from typing import NamedTuple

import numpy as np

from furuta_friction.compensators.adaptive import Adaptive
from furuta_model.compiled import inlined
from furuta_model.friction.levels import copied
from furuta_model.friction.parameters import Friction
from furuta_model.own_functions import OwnMemory, begin_own, call_own


class OwnCompensation(NamedTuple):
    """What an own compensator gets as ``p``."""

    friction: Friction = Friction()
    observer_gain: float = 0.0
    adaptation_gain: float = 0.0
    sample_time: float = 0.0


@inlined
def estimate(memory: OwnMemory, x: np.ndarray, function: int, p: Adaptive) -> float:
    """F̂ [V] for the state estimate ``x`` (5,)."""
    joint = p.joint
    given = OwnCompensation(copied(joint.friction), joint.observer_gain, p.rate, joint.sample_time)
    begin_own(memory, function)
    return call_own(function, (memory.numbers, x, given))
