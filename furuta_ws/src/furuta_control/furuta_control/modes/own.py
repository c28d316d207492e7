"""A mode of the user's own: a function u = f(memory, x, friction, p), called by its address."""

from typing import NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.own_functions import OwnMemory, begin_own, call_own


class OwnControl(NamedTuple):
    """What an own controller gets as ``p``: L of u = −Lx, arm angle, limit and sample time."""

    l1: float = 0.0
    l2: float = 0.0
    l3: float = 0.0
    l4: float = 0.0
    arm_reference: float = 0.0
    voltage_limit: float = 0.0
    sample_time: float = 0.0


@inlined
def command(
    memory: OwnMemory, x: np.ndarray, friction: float, function: int, given: OwnControl
) -> float:
    """Command u [V], unsaturated, for the state estimate ``x``."""
    begin_own(memory, function)
    return call_own(function, (memory.numbers, x, friction, given))
