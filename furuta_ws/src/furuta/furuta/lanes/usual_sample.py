"""The usual sample of estimator, friction observer and controller: without rare cases.

A loop over lanes becomes vector instructions only if its body has no branch that leaves it. These
functions therefore compute only what nearly every sample needs. Each gives the bits of the function
of a single run in the samples for which its condition holds.
"""

from math import isnan

import numpy as np

from furuta_control import estimation, readings
from furuta_control.control import ControllerDesign, ControllerMemory, limited
from furuta_control.estimation import UNFILTERED, EstimatorDesign, EstimatorMemory
from furuta_control.modes import balance
from furuta_friction.compensation import CompensationDesign, CompensationMemory, compensate
from furuta_model.compiled import inlined
from furuta_model.state import PHI, PHI_DOT


@inlined
def estimate_continues(
    memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign
) -> bool:
    """Whether the estimate goes on with this method and every reading is usable."""
    running = p.method + 1 if p.filtered else UNFILTERED
    usable = readings.all_usable(memory.readings, measurement, p.readings)
    return (memory.running == running) & estimation.is_bounded(memory) & usable


@inlined
def continue_estimate(
    memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> None:
    """:func:`furuta_control.estimation.estimate_state` for an estimate that continues."""
    readings.forget_unusable(memory.readings)
    if p.filtered:
        estimation.update(p.method, memory, measurement, p)
    else:
        estimation.take_measurement(memory, measurement)
    estimation.finish(memory, measurement, p, estimate)


@inlined
def estimate_friction(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> float:
    """F̂ [V] if the compensation never changes: no observer runs idle."""
    if isnan(x[PHI_DOT] + x[PHI]):
        return 0.0
    return compensate(p.kind, memory, x, p)


@inlined
def balancing_continues(memory: ControllerMemory, x: np.ndarray, p: ControllerDesign) -> bool:
    """Whether the pendulum was balanced and still is; the mode is ``balance``."""
    return memory.balance.balancing & balance.is_allowed(x, p.balance)


@inlined
def continue_balancing(
    memory: ControllerMemory, x: np.ndarray, friction: float, p: ControllerDesign
) -> float:
    """:func:`furuta_control.control.control` for balancing that continues."""
    return limited(balance.command(memory.balance, x, friction, p.balance), p)
