"""Recorded measurements through estimator, observer and controller again, as the nodes do it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_analysis.simulation.closed_loop import Loop, Memory, fresh_memory
from furuta_control.controller import StateFeedback, control, state_feedback
from furuta_control.estimator import EstimatorDesign, design_estimator, estimate_state
from furuta_friction.compensators import Compensator, compensator, estimate_friction
from furuta_model.compiled import compiled
from furuta_model.state import SIGNALS


class Recomputed(NamedTuple):
    """What the nodes make of measurements: estimate (n, 5), friction estimate and command (n,)."""

    estimate: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray


def recompute(measurement: np.ndarray, changes: list[tuple[int, Loop]]) -> Recomputed:
    """Run ``measurement`` (n, 5) through the loop's members, the plant apart.

    ``changes`` says from which sample on which parameters are in force, the first from 0.
    Memories stay through a change, as the nodes' do.
    """
    n = len(measurement)
    result = Recomputed(np.empty((n, SIGNALS)), np.empty(n), np.empty(n))
    memory = fresh_memory()
    ends = [start for start, _ in changes[1:]] + [n]
    for (start, loop), end in zip(changes, ends, strict=True):
        _run(
            measurement[start:end],
            memory,
            design_estimator(loop.estimator),
            compensator(loop.observer),
            state_feedback(loop.controller),
            Recomputed(*(series[start:end] for series in result)),
        )
    return result


@compiled
def _run(
    measurement: np.ndarray,
    memory: Memory,
    estimation: EstimatorDesign,
    observer: Compensator,
    feedback: StateFeedback,
    result: Recomputed,
) -> None:
    for k in range(len(measurement)):
        estimate = result.estimate[k]
        estimate_state(memory.estimator, measurement[k], estimation, estimate)
        friction = estimate_friction(memory.observer, estimate, observer)
        result.friction_estimate[k] = friction
        result.command[k] = control(memory.controller, estimate, friction, feedback)
