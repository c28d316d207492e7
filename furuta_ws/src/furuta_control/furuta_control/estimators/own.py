"""A method of the user's own: a function f(memory, x, measurement, p) that moves the estimate x."""

from typing import NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.own_functions import OwnMemory, begin_own, call_own
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import SIGNALS


class OwnEstimation(NamedTuple):
    """What an own estimator gets as ``p``: nominal model, viscous friction and sample time."""

    model: FurutaPendulum = FurutaPendulum()
    viscous: float = 0.0
    sample_time: float = 0.0


@inlined
def update(
    memory: OwnMemory, x: np.ndarray, measurement: np.ndarray, function: int, p: OwnEstimation
) -> None:
    """Move the estimate ``x`` by one sample with a ``measurement``; NaN if the function fails."""
    m = p.model
    model = FurutaPendulum(m.alpha, m.beta, m.gamma, m.delta)
    given = OwnEstimation(model, p.viscous, p.sample_time)
    begin_own(memory, function)
    if call_own(function, (memory.numbers, x, measurement, given)) == 0.0:
        for i in range(SIGNALS):
            x[i] = np.nan
