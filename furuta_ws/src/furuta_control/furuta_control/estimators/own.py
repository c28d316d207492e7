"""A method of the user's own: a function f(memory, x, measurement, p) that moves the estimate x."""

from typing import Any, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.own_functions import begin_own, call_own
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import SIGNALS


class OwnEstimation(NamedTuple):
    """What an own estimator gets as ``p``: nominal model, viscous friction and sample time."""

    model: FurutaPendulum = FurutaPendulum()
    viscous: float = 0.0
    sample_time: float = 0.0


@inlined
def update(memory: Any, measurement: np.ndarray, p: Any) -> None:
    """Move the estimate by one sample with a ``measurement`` (5,); NaN if the function fails."""
    m = p.own.model
    model = FurutaPendulum(m.alpha, m.beta, m.gamma, m.delta)
    given = OwnEstimation(model, p.own.viscous, p.own.sample_time)
    begin_own(memory.own, p.function)
    if call_own(p.function, (memory.own.numbers, memory.estimate, measurement, given)) == 0.0:
        for i in range(SIGNALS):
            memory.estimate[i] = np.nan
