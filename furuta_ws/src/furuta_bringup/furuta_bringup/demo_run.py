"""The demo: the paper's Figs 6 to 9 and the recommended setting, through the graph in lock-step.

First the compensator is tuned on a graph of its own. Then one pendulum keeps running while the
compensation is switched. Both use the parameter services, as a user would.
"""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from rclpy.node import Node

from furuta.studies.phases import COMPENSATIONS, TUNED, Phase
from furuta.studies.tuning.plan import TuningPlan, TuningResult, observer_parameters
from furuta.studies.tuning.tuning import ProgressCallback, tune
from furuta_friction.compensation import ObserverParameters
from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.parameter_client import ParameterClient
from furuta_graph.tuning_client import EstimateBuffer, TuningClient
from furuta_model.parameters import build
from furuta_recordings.recorder_node import RecorderNode
from furuta_sim.settings.nodes import CONTROLLER, FRICTION_OBSERVER
from furuta_sim.settings.parameter_files import settings_file
from furuta_sim.settings.recommended import CONTROLLER_NAMES, RECOMMENDED
from furuta_sim.settings.settings import Settings, settings_with


class PausingLoop(TuningClient):
    """A graph in lock-step that pauses between two calls of :meth:`watch`.

    The sample at which a parameter changes is therefore known, and the tuning repeatable.
    """

    def __init__(
        self, graph: SimulatedGraph, client: ParameterClient, estimates: EstimateBuffer
    ) -> None:
        super().__init__(client, estimates, graph.executor)
        self._graph = graph
        self._end = 0.0

    def watch(self, seconds: float) -> np.ndarray:
        """Run for ``seconds`` of pendulum time, pause, and return the estimates (n, 5)."""
        self._end += seconds
        self.client.set("plant", run_until=self._end)
        estimates = super().watch(seconds)
        self._graph.run_until(self._end)
        return estimates


def tune_graph(settings: Settings, plan: TuningPlan, report: ProgressCallback) -> TuningResult:
    """Tune a graph of its own with ``settings``, in lock-step."""
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
    settings: Settings, tuned: dict[str, Any], seconds: float, bag: Path
) -> Iterator[Phase]:
    """Run every compensation for ``seconds``, and record the graph into ``bag``.

    ``tuned`` are the parameters of the friction observer after the tuning.
    """
    node = Node("furuta_demo")
    settings = _in_lockstep(settings)
    record = partial(RecorderNode, bag, stamped=True, parameters=settings_file(settings))
    graph = SimulatedGraph(settings, [node], record)
    try:
        client = ParameterClient(node, graph.executor)
        for number, compensation in enumerate(COMPENSATIONS):
            began = perf_counter()
            end = (number + 1) * seconds
            for each, changes in _changes(compensation, tuned, settings).items():
                client.set_all(each, changes)
            client.set("plant", run_until=end)
            graph.run_until(end)
            yield Phase(compensation, number * seconds, end, perf_counter() - began)
    finally:
        graph.close()


def _changes(
    compensation: str, tuned: dict[str, Any], settings: Settings
) -> dict[str, dict[str, Any]]:
    """The parameters that a phase sets, by node; the last one has the model before the tuning."""
    if compensation == TUNED:
        return {FRICTION_OBSERVER: tuned}
    if compensation != RECOMMENDED:
        return {FRICTION_OBSERVER: {"compensation": compensation}}
    chosen = settings_with(settings, [("compensation", RECOMMENDED)])
    observer = build(ObserverParameters, chosen[FRICTION_OBSERVER])
    return {
        FRICTION_OBSERVER: observer_parameters(observer),
        CONTROLLER: {name: chosen[CONTROLLER][name] for name in CONTROLLER_NAMES},
    }
