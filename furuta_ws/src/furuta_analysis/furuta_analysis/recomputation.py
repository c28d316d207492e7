"""Recorded measurements through estimator, observer and controller again, as the nodes do it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_control.controller import MEMORY as CONTROLLER_MEMORY
from furuta_control.controller import StateFeedback, control, state_feedback
from furuta_control.estimator import MEMORY as ESTIMATOR_MEMORY
from furuta_control.estimator import LowPass, estimate_state, sample_filter
from furuta_friction.compensators import MEMORY as OBSERVER_MEMORY
from furuta_friction.compensators import Compensator, compensator, estimate_friction
from furuta_model.compiled import compiled
from furuta_model.state import RIGID_STATES

from .closed_loop import Loop


class Recomputed(NamedTuple):
    """What the nodes make of measurements: estimate (n, 4), friction estimate and command (n,)."""

    estimate: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray


def recompute(measurement: np.ndarray, changes: list[tuple[int, Loop]]) -> Recomputed:
    """Run ``measurement`` (n, 4) through the loop's members, the plant apart.

    ``changes`` says from which sample on which parameters are in force, the first from 0.
    Memories stay through a change, as the nodes' do.
    """
    n = len(measurement)
    result = Recomputed(np.empty((n, RIGID_STATES)), np.empty(n), np.empty(n))
    memories = (np.zeros(ESTIMATOR_MEMORY), np.zeros(OBSERVER_MEMORY), np.zeros(CONTROLLER_MEMORY))
    ends = [start for start, _ in changes[1:]] + [n]
    for (start, loop), end in zip(changes, ends, strict=True):
        _run(
            measurement[start:end],
            *memories,
            sample_filter(loop.estimator),
            compensator(loop.observer),
            state_feedback(loop.controller),
            Recomputed(*(series[start:end] for series in result)),
        )
    return result


@compiled
def _run(
    measurement: np.ndarray,
    filter_memory: np.ndarray,
    observer_memory: np.ndarray,
    controller_memory: np.ndarray,
    filter_: LowPass,
    observer: Compensator,
    feedback: StateFeedback,
    result: Recomputed,
) -> None:
    for k in range(len(measurement)):
        estimate = result.estimate[k]
        estimate_state(filter_memory, measurement[k], filter_, estimate)
        friction = estimate_friction(observer_memory, estimate, observer)
        result.friction_estimate[k] = friction
        result.command[k] = control(controller_memory, estimate, friction, feedback)
