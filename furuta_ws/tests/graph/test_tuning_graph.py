"""Tuning a graph of real nodes through their parameter services."""

from typing import Any

import numpy as np
import pytest
from rclpy.node import Node

from furuta.settings.nodes import CONTROLLER, FRICTION_OBSERVER, NODES
from furuta.settings.settings import Settings, load_settings, loop
from furuta.studies.trials import Compensation, TuningResult
from furuta.studies.tuning import tune, tune_simulated
from furuta.studies.tuning_plan import TuningPlan
from furuta_bringup.demo_run import in_lockstep
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_bringup.graph.services import ServiceError
from furuta_bringup.tuning_client import EstimateBuffer, TuningClient
from furuta_model.parameters import values
from furuta_ros.spinning import executor_of


def silent(message: str, seconds: float) -> None:
    """Ignore progress."""


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


def tune_graph(settings: Settings, plan: TuningPlan) -> TuningResult:
    """Tune a graph of its own with ``settings``, in lock-step."""
    node = Node("tuner")
    estimates = EstimateBuffer(node)
    graph = SimulatedGraph(in_lockstep(settings), [node])
    try:
        rig = PausingLoop(graph, ParameterClient(node, graph.executor), estimates)
        return tune(rig, rig.compensation, plan, silent)
    finally:
        graph.close()


@pytest.mark.long
def test_tuning_the_graph_is_tuning_the_simulation(ros: None) -> None:
    """In lock-step, paused at every change: the same trials and parameters to the last bit."""
    late = (
        *("plant.drive.delay=10", "plant.drive.lag=0.015"),
        *("friction.law=coulomb", "plant.friction.alpha0=0.63", "compensation=recommended"),
    )
    settings = load_settings([], late)
    plan = TuningPlan(80.0)
    expected = tune_simulated(loop(settings), plan, silent)
    assert tune_graph(settings, plan) == expected
    assert expected.gain
    assert len(expected.trials) > 1


class RefusingController:
    """Parameter services of nodes, of which the controller refuses what is set."""

    def __init__(self) -> None:
        self.held = {name: values(node.parameters()) for name, node in NODES.items()}

    def get(self, node: str, names: list[str]) -> dict[str, Any]:
        """Values of a node."""
        return {name: self.held[node][name] for name in names}

    def set_all(self, node: str, changes: dict[str, Any]) -> None:
        """Set values of a node."""
        if node == CONTROLLER:
            raise ServiceError("refused")
        self.held[node] |= changes


def test_what_one_node_has_taken_is_restored(ros: None) -> None:
    """Although the other one has refused its part of a compensation."""
    services: Any = RefusingController()
    node = Node("tuner")
    rig = TuningClient(services, EstimateBuffer(node), executor_of([node]))
    start = rig.compensation
    weaker = start.controller.balance._replace(strength=0.5)
    with pytest.raises(ServiceError):
        rig.apply(
            Compensation(
                start.estimator,
                start.observer._replace(compensation="lugre"),
                start.controller._replace(balance=weaker),
            )
        )
    assert services.held[FRICTION_OBSERVER]["compensation"] == "lugre"
    rig.apply(start)
    assert services.held[FRICTION_OBSERVER]["compensation"] == "none"
    node.destroy_node()
