"""Falls and resets of the simulated rig, by the services that a user calls.

FURUTA_RESETS sets the number of falls in each test.
"""

import os
from pathlib import Path

import numpy as np
import pytest
from rclpy.node import Node
from std_srvs.srv import Trigger

from furuta.studies.recomputation import compare, new_starts, recompute_bag
from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.parameter_client import ParameterClient
from furuta_recordings.recorder_node import RecorderNode
from furuta_ros.spinning import spin_until
from furuta_sim.settings.settings import load_settings

RESETS = int(os.environ.get("FURUTA_RESETS", "1"))
METHODS = ("kalman", "lowpass")


class ResetGraph:
    """A graph with a client that switches the controller and resets the plant."""

    def __init__(self, *assignments: str, bag: Path | None = None) -> None:
        settings = load_settings([], list(assignments))
        self.node = Node("user")
        self.graph = SimulatedGraph(
            settings, [self.node], record=bag and (lambda: RecorderNode(bag, stamped=True))
        )
        self.plant = self.graph.plant
        self._client = ParameterClient(self.node, self.graph.executor)
        self._reset = self.node.create_client(Trigger, "plant/reset")

    def run(self, seconds: float) -> float:
        """Run for ``seconds`` of the pendulum's time; return the largest |θ| [rad] meanwhile."""
        plant, largest = self.plant, 0.0
        end = plant.time + seconds

        def done() -> bool:
            nonlocal largest
            largest = max(largest, abs(plant.x[2]))
            return plant.time >= end

        spin_until(self.graph.executor, done)
        return largest

    def reset(self) -> None:
        """Call the service and wait for its answer."""
        answer = self._reset.call_async(Trigger.Request())
        spin_until(self.graph.executor, answer.done)
        assert answer.result().success

    def enable(self, enabled: bool) -> None:
        """Switch the controller."""
        self._client.set("controller", enabled=enabled)


def fall_and_reset(graph: ResetGraph) -> int:
    """Let the pendulum fall and reset it, ``RESETS`` times; return how often it was recovered."""
    recovered = 0
    for _ in range(RESETS):
        graph.run(0.5)
        graph.enable(False)
        assert graph.run(4.0) > np.pi / 2
        graph.enable(True)
        graph.reset()
        recovered += graph.run(2.0) < 0.5
    return recovered


@pytest.mark.timeout(60 + 15 * RESETS)
@pytest.mark.parametrize("method", METHODS)
def test_lockstep_recovers_by_reset(ros: None, method: str, tmp_path: Path) -> None:
    """Every fall; and the recording with its resets can be recomputed."""
    bag = tmp_path / "bag"
    graph = ResetGraph("clock=lockstep", f"method={method}", bag=bag)
    try:
        assert fall_and_reset(graph) == RESETS
    finally:
        graph.graph.close()
    recorded, recomputed = recompute_bag(bag, (), (f"method={method}",))
    assert len(new_starts(recorded.stamps)) == RESETS
    assert compare(recorded, recomputed)["estimate"]["identical"]


def test_reset_of_a_balanced_pendulum(ros: None) -> None:
    """The loop continues from the initial state, at rest and in the middle."""
    graph = ResetGraph("clock=lockstep")
    graph.run(1.0)
    before = graph.plant.sample
    graph.reset()
    assert graph.plant.sample >= before + 200
    assert graph.run(3.0) < 0.2
    graph.graph.close()
