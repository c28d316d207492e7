"""Recomputes estimates and commands from recorded measurements, as the nodes compute them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_analysis.simulation.closed_loop import Loop
from furuta_analysis.simulation.control_system import (
    ControlSystem,
    Memory,
    control_sample,
    design_control_system,
    initial_memory,
)
from furuta_model.compiled import compiled
from furuta_model.state import SIGNALS


class Recomputed(NamedTuple):
    """Recomputed series: estimate (n, 5), friction estimate (n,) [V] and command (n,) [V]."""

    estimate: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray


def recompute(measurement: np.ndarray, changes: list[tuple[int, Loop]]) -> Recomputed:
    """Process ``measurement`` (n, 5) by estimator, friction observer and controller.

    ``changes`` lists parameters and the sample from which they apply; the first must be 0. The
    memories are kept over a change, as in the nodes.
    """
    n = len(measurement)
    result = Recomputed(np.empty((n, SIGNALS)), np.empty(n), np.empty(n))
    memory = initial_memory()
    ends = [start for start, _ in changes[1:]] + [n]
    for (start, loop), end in zip(changes, ends, strict=True):
        _run(
            measurement[start:end],
            memory,
            design_control_system(loop.estimator, loop.observer, loop.controller),
            Recomputed(*(series[start:end] for series in result)),
        )
    return result


@compiled
def _run(
    measurement: np.ndarray, memory: Memory, control_system: ControlSystem, result: Recomputed
) -> None:
    for k in range(len(measurement)):
        result.friction_estimate[k], result.command[k] = control_sample(
            memory.estimator,
            memory.observer,
            memory.controller,
            measurement[k],
            control_system,
            result.estimate[k],
        )
