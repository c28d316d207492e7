"""Combines estimator, friction observer and controller: from a measurement to a command.

The three nodes call the same functions in the same order and exchange messages between them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_control import control as controller
from furuta_control.control import MEMORY as CONTROLLER_MEMORY
from furuta_control.control import (
    ControllerDesign,
    ControllerParameters,
    control,
    design_controller,
)
from furuta_control.estimation import MEMORY as ESTIMATOR_MEMORY
from furuta_control.estimation import (
    EstimatorDesign,
    EstimatorParameters,
    design_estimator,
    estimate_state,
    restart,
)
from furuta_friction import compensation
from furuta_friction.compensation import MEMORY as OBSERVER_MEMORY
from furuta_friction.compensation import (
    Compensator,
    ObserverParameters,
    design_compensator,
    estimate_friction,
)
from furuta_model.compiled import inlined


class ControlSystem(NamedTuple):
    """The control system as :func:`control_sample` uses it."""

    estimator: EstimatorDesign
    observer: Compensator
    controller: ControllerDesign


class Memory(NamedTuple):
    """Memory of estimator, friction observer and controller from sample to sample."""

    estimator: np.ndarray
    observer: np.ndarray
    controller: np.ndarray


def design_control_system(
    estimator: EstimatorParameters, observer: ObserverParameters, controller: ControllerParameters
) -> ControlSystem:
    """The control system that the parameters describe."""
    return ControlSystem(
        design_estimator(estimator), design_compensator(observer), design_controller(controller)
    )


def initial_memory() -> Memory:
    """The memory of a control system before its first measurement."""
    sizes = (ESTIMATOR_MEMORY, OBSERVER_MEMORY, CONTROLLER_MEMORY)
    return Memory(*(np.zeros(size) for size in sizes))


def reset(memory: Memory) -> None:
    """Prepare for a measurement that does not continue the ones before, as the nodes do."""
    restart(memory.estimator)
    compensation.reset(memory.observer)
    controller.reset(memory.controller)


@inlined
def control_sample(
    estimator_memory: np.ndarray,
    observer_memory: np.ndarray,
    controller_memory: np.ndarray,
    measurement: np.ndarray,
    p: ControlSystem,
    estimate: np.ndarray,
) -> tuple[float, float]:
    """Friction estimate F̂ [V] and command u [V] for a ``measurement`` (5,).

    The memories are updated, ``estimate`` (5,) is written. The memories are separate arguments,
    because taking an array from a tuple in a loop costs as much as a filter.
    """
    estimate_state(estimator_memory, measurement, p.estimator, estimate)
    friction = estimate_friction(observer_memory, estimate, p.observer)
    return friction, control(controller_memory, estimate, friction, p.controller)
