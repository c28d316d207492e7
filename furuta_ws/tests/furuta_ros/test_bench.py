"""The bench for tests of one's own: it says what is wrong with a test."""

from math import nan

import pytest
from rclpy.node import Node

from furuta_ros.testing import Bench
from furuta_ros.topics import COMMAND


def test_a_mistake_in_a_test_is_an_error(bench: Bench) -> None:
    """A time that the plant refuses, and a name that no node has."""
    plant = bench.add(Node("plant", allow_undeclared_parameters=True))
    refused = type("Result", (), {"successful": False, "reason": "at most 1 s"})
    plant.set_parameters = lambda parameters: [refused]
    with pytest.raises(ValueError, match="at most 1 s"):
        bench.run_until(nan)
    with pytest.raises(LookupError, match="no node plantt on the bench; it has probe, plant"):
        bench.node("plantt")


def test_a_late_node_is_heard_once(bench: Bench) -> None:
    """Both calls of ``collect`` return the same list."""
    received = bench.collect(COMMAND)
    bench.settle(0.01)
    late = bench.add(Node("late"))
    late.create_timer(0.01, lambda: publisher.publish(COMMAND.message()))
    publisher = late.create_publisher(COMMAND.message, COMMAND.name, 10)
    assert bench.collect(COMMAND) is received
    bench.spin(lambda: len(received) > 0)
    assert publisher.get_subscription_count() == 1
