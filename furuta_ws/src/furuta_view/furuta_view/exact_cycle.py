"""The exact limit cycle without compensation, for the parameters that the nodes have now."""

from __future__ import annotations

from typing import Any

import numpy as np

from furuta.limit_cycles.ideal_loop import IdealLoop
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.periodic_orbit import trace
from furuta_control.control import ControllerParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.friction.laws import analysed_law
from furuta_model.parameters import ParameterError, build
from furuta_sim.parameters import PlantNodeParameters

# What the motion depends on; other parameters need no new computation.
RELEVANT = ("model.", "friction.", "omega", "zeta", "gain", "alpha", "sigma", "stribeck", "viscous")


def relevant(values: dict[str, dict[str, Any]]) -> tuple[Any, ...]:
    """The values that the cycle depends on, to see whether it must be computed again."""
    return tuple(
        (node, name, str(value))
        for node in ("plant", "controller", "friction_observer")
        for name, value in values.get(node, {}).items()
        if name.startswith(RELEVANT)
    )


def exact_cycle(values: dict[str, dict[str, Any]]) -> np.ndarray | None:
    """Time and state (n, 6) of the cycle; None if there is none, or parameters are missing.

    Without a simulated plant, model and friction are those that controller and friction observer
    assume.
    """
    try:
        loop = _ideal_loop(values)
        cycle = limit_cycle(loop)
        if cycle.kind != "oscillation" or not np.isfinite(cycle.period_s):
            return None
        motion = trace(loop, cycle)
    except (KeyError, ParameterError):
        return None
    return np.column_stack([motion.time, motion.state])


def _ideal_loop(values: dict[str, dict[str, Any]]) -> IdealLoop:
    controller = build(ControllerParameters, values["controller"])
    if "plant" in values:
        plant = build(PlantNodeParameters, values["plant"]).plant
        model, law, friction = plant.model, plant.friction.law, plant.friction.parameters
    else:
        observer = build(ObserverParameters, values["friction_observer"])
        model, law, friction = controller.model, "lugre", observer.friction
    l1, l2, l3, l4 = (-each for each in controller.feedback_gain)
    return IdealLoop(model, analysed_law(law, friction), l1, l2, l3, l4)
