"""The bench for tests of one's own: it says what is wrong with a test."""

from math import nan

import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter

from furuta_ros.testing import Bench
from furuta_ros.topics import COMMAND


class Plant(Node):
    """Accepts no time beyond 1 s."""

    paused = True

    def set_parameters(self, parameter_list: list[Parameter]) -> list[object]:
        """As ROS does."""
        accepted = all(each.value <= 1.0 for each in parameter_list)
        return [type("Result", (), {"successful": accepted, "reason": "at most 1 s"})]


def test_a_mistake_in_a_test_is_an_error(bench: Bench) -> None:
    """A time that the plant refuses, and a name that no node has."""
    bench.add(Plant("plant"))
    bench.run_until(1.0)
    for wrong in (2e9, nan):
        with pytest.raises(ValueError, match="at most 1 s"):
            bench.run_until(wrong)
    with pytest.raises(LookupError, match="no node plantt on the bench; it has probe, plant"):
        bench.node("plantt")


def test_a_topic_is_collected_once_from_a_node_that_comes_late(bench: Bench) -> None:
    """Both calls return the same list, with each message once; the late node is served."""
    received = bench.collect(COMMAND)
    bench.settle(0.01)
    late, heard = bench.add(Node("late")), []
    late.create_subscription(COMMAND.message, COMMAND.name, heard.append, 10)
    publisher = late.create_publisher(COMMAND.message, COMMAND.name, 10)
    assert bench.collect(COMMAND) is received
    bench.spin(lambda: publisher.get_subscription_count() == 2)
    publisher.publish(COMMAND.message(data=1.0))
    bench.spin(lambda: len(heard) == 1)
    bench._catch_up()
    assert len(received) == 1
