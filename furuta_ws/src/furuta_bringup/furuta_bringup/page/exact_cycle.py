"""The pendulum and its exact limit cycle for the parameters that the nodes have now."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from furuta.describing_functions.predicted_cycles import predict_cycles
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import trace
from furuta.loops import ideal_loop
from furuta.settings.nodes import CONTROLLER, ESTIMATOR, FRICTION_OBSERVER, NODES, PLANT
from furuta.transfer import transfer
from furuta_model.friction.laws import friction_law
from furuta_model.parameters import ParameterError, build
from furuta_model.pendulum import FurutaPendulum
from furuta_sim.simulation.closed_loop import Loop

POINTS = 200  # of the orbit
# Values by node and parameter name.
Values = Mapping[str, Mapping[str, Any]]


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


def described_cycle(loop: IdealLoop) -> dict[str, Any] | None:
    """The exact cycle and its prediction, as the page shows them; None if there is none.

    ``exact`` and ``predicted``, by the describing function, are the arm's peak to peak [rad];
    ``orbit`` has its angle about the middle and its speed [rad, rad/s].
    """
    try:
        cycle = limit_cycle(loop)
        if cycle.kind != "limit_cycle" or not np.isfinite(cycle.period_s):
            return None
        predicted = predict_cycles(transfer(loop.body, loop.gains), loop.law).cycles
    except ParameterError:
        return None
    stable = [each.phi_peak_to_peak_rad for each in predicted if each.stable]
    if not stable:
        return None
    orbit = trace(loop, cycle).state[:, :2]
    orbit[:, 0] -= (orbit[:, 0].max() + orbit[:, 0].min()) / 2
    shown = orbit[:: 1 + len(orbit) // POINTS].round(5).tolist()
    return {"exact": cycle.phi_peak_to_peak_rad, "predicted": stable[-1], "orbit": shown}


def _built(node: str, values: Values) -> Any:
    return build(NODES[node].parameters, values[node])
