"""A mode of the user's own: a function u = f(memory, x, friction, p), called by its address."""

from typing import Any, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.own_functions import begin_own, call_own


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
def command(memory: Any, x: np.ndarray, friction: float, p: Any) -> float:
    """Command u [V], unsaturated, for the state estimate ``x``."""
    b = p.balance
    given = OwnControl(b.l1, b.l2, b.l3, b.l4, b.arm_reference, p.voltage_limit, p.sample_time)
    begin_own(memory.own, p.function)
    return call_own(p.function, (memory.own.numbers, x, friction, given))
