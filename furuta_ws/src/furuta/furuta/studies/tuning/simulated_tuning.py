"""Tunes the LuGre compensator of a simulated loop, where no guard has to protect a rig."""

from __future__ import annotations

from furuta.studies.tuning.plan import TuningPlan
from furuta.studies.tuning.tunable_loop import GuardError, SimulatedLoop
from furuta.studies.tuning.tuning import ProgressCallback, tune
from furuta_friction.compensation import ObserverParameters
from furuta_model.parameters import ParameterError
from furuta_sim.simulation.closed_loop import Loop

# A simulated arm may move far; a pendulum beyond 1.5 rad has fallen.
PLAN = TuningPlan(arm_guard=100.0, pendulum_guard=1.5)


def tuned_observer(loop: Loop, report: ProgressCallback) -> ObserverParameters:
    """The tuned friction observer of ``loop``; :class:`ParameterError` if it cannot be tuned."""
    try:
        result = tune(SimulatedLoop(loop), loop.observer, loop.estimator, PLAN, report)
    except (GuardError, ValueError) as error:
        raise ParameterError(f"cannot tune the compensator of this loop: {error}") from None
    return result.after.observer
