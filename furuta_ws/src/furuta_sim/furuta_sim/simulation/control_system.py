"""Combines estimator, friction observer and controller: from a measurement to a command.

The three nodes call the same functions in the same order and exchange messages between them.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from furuta_control import control as controller
from furuta_control.control import (
    ControllerDesign,
    ControllerMemory,
    ControllerParameters,
    control,
    design_controller,
)
from furuta_control.estimation import (
    EstimatorDesign,
    EstimatorMemory,
    EstimatorParameters,
    design_estimator,
    estimate_state,
    restart,
)
from furuta_friction import compensation
from furuta_friction.compensation import (
    CompensationDesign,
    CompensationMemory,
    ObserverParameters,
    design_compensator,
    estimate_friction,
)
from furuta_model.compiled import inlined


class ControlSystem(NamedTuple):
    """The control system as :func:`control_sample` uses it."""

    estimator: EstimatorDesign
    observer: CompensationDesign
    controller: ControllerDesign


@dataclass
class ControlMemory:
    """What estimator, friction observer and controller remember."""

    estimator: EstimatorMemory = field(default_factory=EstimatorMemory)
    observer: CompensationMemory = field(default_factory=CompensationMemory)
    controller: ControllerMemory = field(default_factory=ControllerMemory)


def design_control_system(
    estimator: EstimatorParameters, observer: ObserverParameters, controller: ControllerParameters
) -> ControlSystem:
    """The control system that the parameters describe."""
    return ControlSystem(
        design_estimator(estimator), design_compensator(observer), design_controller(controller)
    )


@inlined
def reset(memory: ControlMemory) -> None:
    """Prepare for a measurement that does not continue the ones before, as the nodes do."""
    restart(memory.estimator)
    compensation.reset(memory.observer)
    controller.reset(memory.controller)


@inlined
def control_sample(
    memory: ControlMemory, measurement: np.ndarray, p: ControlSystem, estimate: np.ndarray
) -> tuple[float, float]:
    """Friction estimate F̂ [V] and command u [V] for a ``measurement`` (5,).

    ``memory`` is updated, ``estimate`` (5,) is written.
    """
    estimate_state(memory.estimator, measurement, p.estimator, estimate)
    friction = estimate_friction(memory.observer, estimate, p.observer)
    return friction, control(memory.controller, estimate, friction, p.controller)
