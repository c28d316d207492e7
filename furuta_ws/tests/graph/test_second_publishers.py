"""Second publishers on the topics of the composed graph in lock-step."""

from typing import Any

import numpy as np
import pytest
from rclpy.node import Node
from std_msgs.msg import Float64
from testbench import joint_state

from furuta_control.controller_node import ControllerNode
from furuta_graph.composed_graph import SimulatedGraph
from furuta_ros.spinning import spin_until
from furuta_ros.topics import (
    COMMAND,
    FRICTION_ESTIMATE,
    JOINT_STATES,
    MEASUREMENT,
    QOS,
    Topic,
)
from furuta_sim.settings.settings import load_settings, loop
from furuta_sim.simulation.closed_loop import simulate

SECONDS = 3.0
# The nodes that receive a topic.
RECEIVERS = {
    MEASUREMENT.name: ["estimator"],
    JOINT_STATES.name: ["friction_observer", "controller"],
    FRICTION_ESTIMATE.name: ["controller"],
    COMMAND.name: ["plant"],
}


def graph(seconds: float, others: tuple[Node, ...] = ()) -> SimulatedGraph:
    settings = load_settings([], ["compensation=lugre"])
    settings["plant"] |= {"clock": "lockstep", "run_until": seconds}
    return SimulatedGraph(settings, others)


def assert_offline_run(running: SimulatedGraph) -> None:
    """The state of the plant is that of the offline loop at the same sample, to the last bit."""
    samples = running.plant.sample + 1
    expected = simulate(loop(load_settings([], ["compensation=lugre"])), samples * 0.001)
    np.testing.assert_array_equal(running.plant.x[:4], expected.state[-1])


def message(topic: Topic) -> Any:
    return Float64(data=0.1) if topic.type is Float64 else joint_state((0.1, 0.2, 0.3, 0.4), 5)


@pytest.mark.parametrize(
    "topic", [MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND], ids=lambda each: each.name
)
def test_stray_messages_change_nothing(ros: None, capfd: Any, topic: Topic) -> None:
    """Nodes that publish once leave the run as it is, and are named."""
    running = graph(SECONDS)
    receivers = RECEIVERS[topic.name]
    count = len(receivers)
    warnings = ""

    def named(k: int) -> bool:
        nonlocal warnings
        warnings += capfd.readouterr().err
        return warnings.count(f"/stray_{k}") >= count

    for k in range(1, 3):
        spin_until(running.executor, lambda k=k: running.plant.time > k)
        stray = Node(f"stray_{k}")
        publisher = stray.create_publisher(topic.type, topic.name, QOS)
        spin_until(running.executor, lambda p=publisher: p.get_subscription_count() == count)
        publisher.publish(message(topic))
        rejected = [running.node(name).accepted_publishers[topic.name] for name in receivers]
        spin_until(running.executor, lambda k=k, r=rejected: all(one.rejected == k for one in r))
        spin_until(running.executor, lambda k=k: named(k))
        stray.destroy_node()
    running.run_until(SECONDS)
    missed = running.node("controller").missed_estimates
    assert_offline_run(running)
    running.close()
    assert missed == 0


def test_a_second_controller_stops_lockstep_until_it_ends(ros: None, capfd: Any) -> None:
    """Neither is accepted; when one is left, the run goes on as if nothing had happened."""
    second = ControllerNode()
    running = graph(SECONDS, (second,))
    one = running.plant.accepted_publishers[COMMAND.name]
    spin_until(running.executor, lambda: one.rejected >= 2)
    assert running.plant.sample == 0
    running.executor.remove_node(second)
    running.nodes.remove(second)
    second.destroy_node()
    running.run_until(SECONDS)
    assert_offline_run(running)
    running.close()
    warnings = capfd.readouterr().err
    assert "2 nodes publish command: /controller and /controller" in warnings
    assert "no message is accepted until there is only one" in warnings
