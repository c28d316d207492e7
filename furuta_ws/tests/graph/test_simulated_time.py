"""Simulated time: published in lock-step, followed with ``use_sim_time``, rejected in real time."""

import gc
from itertools import pairwise
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_bringup.graph.services import ServiceError
from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_ros.errors import UserError
from furuta_ros.spinning import ros_context
from furuta_ros.testing import Bench
from furuta_ros.topics import COMMAND, MEASUREMENT
from furuta_sim.plant_node import PlantNode

SIMULATED = Parameter("use_sim_time", value=True)
LOCKSTEP = Parameter("clock", value="lockstep")
MS = 1_000_000


def published(node: Node) -> list[Publisher]:
    """The node's publishers of time."""
    return [each for each in node.publishers if each.msg_type is Clock]


class LockStep:
    """A plant in lock-step whose commands are 0 V."""

    def __init__(self, bench: Bench) -> None:
        self.node = bench.add(PlantNode([LOCKSTEP]))
        self._bench = bench
        self._commands = bench.publisher(COMMAND)

    def run_to(self, sample: int) -> None:
        """Answer each sample until the plant has published this one."""
        self._bench.spin(lambda: self.node.pacing._is_waiting)
        while (before := self.node.sample) < sample:
            self._commands.publish(Float64())
            self._bench.spin(lambda before=before: self.node.sample > before)


def test_a_node_with_simulated_time_follows_lockstep(bench: Bench) -> None:
    """Its clock is within 10 ms of the stamps, also when it joins while time stands still."""
    bench.collect(MEASUREMENT)
    follower = bench.add(Node("follower", parameter_overrides=[SIMULATED]))
    late = bench.add(Node("late"))
    plant = LockStep(bench)
    ticks: list[int] = []
    follower.create_timer(0.05, lambda: ticks.append(follower.get_clock().now().nanoseconds))
    plant.run_to(234)
    bench.spin(lambda: follower.get_clock().now().nanoseconds == 230 * MS)
    assert ticks
    assert all(b - a == 50 * MS for a, b in pairwise(ticks))
    late.set_parameters([SIMULATED])
    bench.spin(lambda: late.get_clock().now().nanoseconds == 230 * MS)


def test_each_namespace_has_its_own_clock() -> None:
    """Two graphs side by side do not mix their times."""
    with ros_context(namespace="/left"):
        node = PlantNode([LOCKSTEP])
        assert [each.topic_name for each in published(node)] == ["/left/clock"]
        node.destroy_node()


@pytest.mark.parametrize("make", [PlantNode, HardwareBridgeNode])
def test_realtime_rejects_simulated_time(bench: Bench, make: Any) -> None:
    """At the start and by service, with the reason; the node goes on in the system's time."""
    with pytest.raises(UserError, match=r"use_sim_time must be false for .*, given true"):
        make([SIMULATED])
    gc.collect()  # the rejected node would keep its subscription to /clock
    node = bench.add(make())
    client = ParameterClient(bench.probe, bench.executor)
    with pytest.raises(ServiceError, match="use_sim_time must be false"):
        client.set(node.get_name(), use_sim_time=True)
    assert not node.get_parameter("use_sim_time").value
    assert node.get_clock().now().nanoseconds > 10**18
