"""The pendulum and its exact limit cycle for the parameters that the nodes have now."""

from contextlib import suppress
from typing import Any

import numpy as np

from furuta.describing_functions.predicted_cycles import predict_cycles
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import trace
from furuta.loops import ideal_loop
from furuta.settings.nodes import CONTROLLER, ESTIMATOR, FRICTION_OBSERVER, NODES, PLANT
from furuta.transfer import transfer
from furuta_bringup.page.guided_scenes import Values
from furuta_model.friction.laws import friction_law
from furuta_model.parameters import ParameterError, build
from furuta_model.pendulum import FurutaPendulum
from furuta_sim.simulation.closed_loop import Loop


def model_of(values: Values) -> FurutaPendulum:
    """The model of the plant, or that which the estimator assumes, or the paper's."""
    for node in (PLANT, ESTIMATOR):
        given = values.get(node, {})
        if "model.alpha" in given:
            return FurutaPendulum(*(given[f"model.{name}"] for name in FurutaPendulum._fields))
    return FurutaPendulum()


def analysed_loop(values: Values) -> IdealLoop | None:
    """The loop whose cycle is exact; None if it is none, or parameters are missing.

    Without a simulated plant, model and friction are those that controller and friction observer
    assume.
    """
    try:
        controller = _built(CONTROLLER, values)
        if PLANT in values:
            return ideal_loop(Loop(_built(PLANT, values).plant, controller=controller))
        friction = _built(FRICTION_OBSERVER, values).observer.friction
    except (KeyError, ParameterError):
        return None
    l1, l2, l3, l4 = (-gain for gain in controller.feedback_gain)
    return IdealLoop(controller.model, friction_law("lugre", friction), l1, l2, l3, l4)


def exact_cycle(loop: IdealLoop) -> np.ndarray | None:
    """Time and state (n, 6) of the cycle; None if there is none."""
    with suppress(ParameterError):
        cycle = limit_cycle(loop)
        if cycle.kind == "oscillation" and np.isfinite(cycle.period_s):
            motion = trace(loop, cycle)
            return np.column_stack([motion.time, motion.state])
    return None


def cycle_size(cycle: np.ndarray | None) -> float | None:
    """The arm's peak to peak [rad] of :func:`exact_cycle`."""
    return None if cycle is None else float(np.ptp(cycle[:, 1]))


def predicted_size(loop: IdealLoop) -> float | None:
    """The same as the describing function predicts it; None if it predicts no stable cycle."""
    with suppress(ParameterError):
        cycles = predict_cycles(transfer(loop.body, loop.gains), loop.law).cycles
        stable = [cycle for cycle in cycles if cycle.stable]
        return stable[-1].phi_peak_to_peak_rad if stable else None
    return None


def _built(node: str, values: Values) -> Any:
    return build(NODES[node].parameters, values[node])
