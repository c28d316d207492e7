"""The paper's experiment through the real graph: Figs 6 to 9 in sequence.

In lock-step. First the compensator is tuned on a graph of its own; then one pendulum runs on while
the compensation is switched. Both use the parameter services, as a user would.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from rclpy.node import Node

from furuta_analysis.simulation.oscillation import measure_oscillation
from furuta_friction.parameters import ObserverParameters
from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.parameter_client import ParameterClient
from furuta_graph.parameter_files import settings_file
from furuta_graph.settings import Settings
from furuta_graph.tuning_client import EstimateBuffer, TuningClient
from furuta_recordings.bags.recorded_run import RecordedRun
from furuta_recordings.recorder_node import RecorderNode
from furuta_studies.tuning.report import parameters
from furuta_studies.tuning.tuning import Plan, Report, TuningResult, tune

# The phases: the three compensations of the paper, and LuGre as tuned.
TUNED = "tuned"
COMPENSATIONS = ("none", "coulomb", "lugre", TUNED)
# Part of each phase that counts, the last, after the transients.
SETTLED = 0.75


class Phase(NamedTuple):
    """One compensation and when it was in force [s]."""

    compensation: str
    start: float
    end: float
    wall_seconds: float


class PausingLoop(TuningClient):
    """A graph in lock-step that stands still while nobody watches.

    So the sample at which a parameter changes is known, and the tuning repeatable.
    """

    def __init__(
        self, graph: SimulatedGraph, client: ParameterClient, estimates: EstimateBuffer
    ) -> None:
        super().__init__(client, estimates, graph.executor)
        self._graph = graph
        self._end = 0.0

    def watch(self, seconds: float) -> np.ndarray:
        """The estimates (n, 5) of the next ``seconds`` of pendulum time."""
        self._end += seconds
        self.client.set("plant", run_until=self._end)
        estimates = super().watch(seconds)
        self._graph.run_until(self._end)
        return estimates


def tune_graph(settings: Settings, plan: Plan, report: Report) -> TuningResult:
    """Tune a graph with ``settings``, in lock-step and with nobody else near."""
    node = Node("furuta_demo")
    estimates = EstimateBuffer(node)
    graph = SimulatedGraph(_in_lockstep(settings), [node])
    try:
        rig = PausingLoop(graph, ParameterClient(node, graph.executor), estimates)
        return tune(rig, rig.observer, rig.estimator, plan, report)
    finally:
        graph.close()


def _in_lockstep(settings: Settings) -> Settings:
    settings = {node: dict(given) for node, given in settings.items()}
    settings["plant"] |= {"clock": "lockstep", "run_until": 0.0}
    settings["friction_observer"]["compensation"] = COMPENSATIONS[0]
    return settings


def run_demo(
    settings: Settings,
    tuned: ObserverParameters,
    seconds: float,
    bag: Path,
    progress: Callable[[float], None],
) -> list[Phase]:
    """Run every compensation for ``seconds``, recording into ``bag``.

    ``progress`` is told the pendulum's time now and then.
    """
    node = Node("furuta_demo")
    settings = _in_lockstep(settings)
    record = partial(RecorderNode, bag, stamped=True, parameters=settings_file(settings))
    graph = SimulatedGraph(settings, [node], record)
    try:
        graph.plant.create_timer(0.1, lambda: progress(graph.plant.time))
        client = ParameterClient(node, graph.executor)
        phases = []
        for number, compensation in enumerate(COMPENSATIONS):
            began = perf_counter()
            end = (number + 1) * seconds
            chosen = parameters(tuned) if compensation == TUNED else {"compensation": compensation}
            client.set_all("friction_observer", chosen)
            client.set("plant", run_until=end)
            graph.run_until(end)
            phases.append(Phase(compensation, number * seconds, end, perf_counter() - began))
        progress(graph.plant.time)
        return phases
    finally:
        graph.close()


def evaluate(phases: list[Phase], recorded: RecordedRun) -> list[dict[str, Any]]:
    """What each phase came to, on the recorded truth."""
    rows = []
    for phase in phases:
        settled = recorded.between(phase.start + SETTLED * (phase.end - phase.start), phase.end)
        oscillation = measure_oscillation(settled.state, float(np.diff(settled.time).mean()))
        rows.append(
            {
                "compensation": phase.compensation,
                "phi_peak_to_peak_rad": oscillation.phi_peak_to_peak_rad,
                "theta_peak_to_peak_rad": oscillation.theta_peak_to_peak_rad,
                "period_s": oscillation.period_s,
                "command_rms_v": float(np.sqrt(np.mean(settled.command**2))),
                "samples": len(recorded.between(phase.start, phase.end).time),
                "sim_seconds": phase.end - phase.start,
                "wall_seconds": phase.wall_seconds,
            }
        )
    return rows
