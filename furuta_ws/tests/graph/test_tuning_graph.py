"""Tuning a graph of real nodes through their parameter services."""

import pytest

from furuta.studies.tuning.guarded_loop import SimulatedLoop
from furuta.studies.tuning.plan import MIN_SECONDS, TuningPlan
from furuta.studies.tuning.tuning import tune
from furuta_bringup.demo_run import tune_graph
from furuta_sim.settings.settings import load_settings, loop


def silent(message: str, seconds: float) -> None:
    """Ignore progress."""


@pytest.mark.long
def test_tuning_the_graph_is_tuning_the_simulation(ros: None) -> None:
    """In lock-step, paused at every change: the same trials and parameters to the last bit."""
    settings = load_settings([], ["plant.friction.asymmetry=0.1", "plant.friction.alpha0=0.25"])
    plan = TuningPlan(MIN_SECONDS)
    simulated = loop(settings)
    expected = tune(SimulatedLoop(simulated), simulated.observer, simulated.estimator, plan, silent)
    assert tune_graph(settings, plan, silent) == expected
    assert expected.after.amplitude < 0.03
