"""A fall and a reset of the simulated rig, by the services that a user calls."""

import numpy as np
import pytest
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from furuta.settings.settings import load_settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_ros.node import LATCHED
from furuta_ros.spinning import spin_until
from furuta_ros.time_stamps import stamp_nanoseconds
from furuta_ros.topics import INITIAL_STATE, MEASUREMENT


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


def test_a_state_is_set_and_told(ros: None) -> None:
    """What is left out is 0. A late subscriber hears of it; a mistake changes nothing."""
    user, told, measured = Node("user"), [], []
    graph = SimulatedGraph(load_settings([], ["clock=lockstep"]), [user])
    client = user.create_client(SetParametersAtomically, "plant/set_state")

    def set_state(**values: object) -> SetParametersResult:
        given = [Parameter(name, value=value).to_parameter_msg() for name, value in values.items()]
        answer = client.call_async(SetParametersAtomically.Request(parameters=given))
        spin_until(graph.executor, answer.done)
        return answer.result().result

    try:
        largest_angle(graph, 0.2)
        for wrong, reason in (
            ({"theta": 4.0}, "-3.14159"),
            ({"psi": 0.1}, "a state has phi, phi_dot, theta, theta_dot, given ['psi']"),
            ({"": 0.1}, "given ['']"),
            ({"theta": "up"}, "theta"),
        ):
            refused = set_state(**wrong)
            assert not refused.successful
            assert reason in refused.reason
        assert graph.plant.time < 100.0
        user.create_subscription(MEASUREMENT.message, MEASUREMENT.name, measured.append, 10)
        largest_angle(graph, 0.1)
        assert set_state(phi=0.2, theta=-0.3).successful
        assert graph.plant.x[:4] == pytest.approx([0.2, 0.0, -0.3, 0.0])
        user.create_subscription(INITIAL_STATE.message, INITIAL_STATE.name, told.append, LATCHED)
        spin_until(graph.executor, lambda: told)
        assert list(told[0].position) == [0.2, -0.3]
        assert largest_angle(graph, 4.0) < 0.5
        assert abs(graph.plant.x[2]) < 0.1  # it is balanced again
        stamps = np.array([stamp_nanoseconds(each) for each in measured])
        assert stamp_nanoseconds(told[0]) == stamps[np.argmax(np.diff(stamps)) + 1]
    finally:
        graph.close()
