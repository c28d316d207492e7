"""A fall and a reset of the simulated rig, by the services that a user calls."""

import numpy as np
import pytest
from rclpy.node import Node
from std_srvs.srv import Trigger

from furuta.settings.settings import load_settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_ros.spinning import spin_until


def largest_angle(graph: SimulatedGraph, seconds: float) -> float:
    """Run for ``seconds`` of the pendulum's time; return the largest |θ| [rad] meanwhile."""
    plant, angles = graph.plant, [0.0]
    end = plant.time + seconds
    spin_until(graph.executor, lambda: angles.append(abs(plant.x[2])) or plant.time >= end)
    return max(angles)


def fall_and_reset(graph: SimulatedGraph, user: Node) -> None:
    """The controller is switched off, and on again before the reset."""
    client, reset = (
        ParameterClient(user, graph.executor),
        user.create_client(Trigger, "plant/reset"),
    )
    largest_angle(graph, 0.5)
    client.set("controller", enabled=False)
    spin_until(graph.executor, lambda: abs(graph.plant.x[2]) > np.pi / 2)
    client.set("controller", enabled=True)
    answer = reset.call_async(Trigger.Request())
    spin_until(graph.executor, answer.done)
    assert answer.result().success
    assert largest_angle(graph, 1.0) < 0.5


@pytest.mark.parametrize(
    "clock", ["lockstep", pytest.param("realtime", marks=pytest.mark.realtime)]
)
def test_loop_recovers_by_reset(ros: None, clock: str) -> None:
    user = Node("user")
    graph = SimulatedGraph(load_settings([], [f"clock={clock}"]), [user])
    try:
        fall_and_reset(graph, user)
    finally:
        graph.close()
