"""A compensator of the user's own: a function F̂ = f(memory, x, p), called by its address."""

from typing import NamedTuple

import numpy as np

from furuta_friction.compensators.adaptive import Adaptive
from furuta_model.compiled import inlined
from furuta_model.friction.levels import copied
from furuta_model.friction.parameters import Friction
from furuta_model.own_functions import OwnMemory, begin_own, call_own
from furuta_model.state import APPLIED_TORQUE, OBSERVED_FRICTION


class OwnCompensation(NamedTuple):
    """What an own compensator gets as ``p``."""

    friction: Friction = Friction()
    observer_gain: float = 0.0
    adaptation_gain: float = 0.0
    sample_time: float = 0.0


@inlined
def estimate(
    memory: OwnMemory, x: np.ndarray, observed: float, function: int, p: Adaptive
) -> float:
    """F̂ [V] for the state estimate ``x`` (5,), which the function gets with ``observed`` [V]."""
    joint = p.joint
    given = OwnCompensation(copied(joint.friction), joint.observer_gain, p.rate, joint.sample_time)
    begin_own(memory, function)
    torque, x[OBSERVED_FRICTION] = x[APPLIED_TORQUE], observed
    estimated = call_own(function, (memory.numbers, x, given))
    x[APPLIED_TORQUE] = torque
    return estimated
