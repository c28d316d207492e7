"""Second publishers on the topics of the composed graph: they are named."""

from typing import Any

import pytest
from rclpy.node import Node

from furuta.settings.settings import default_settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_ros.node import QOS
from furuta_ros.spinning import spin_until
from furuta_ros.topics import COMMAND, JOINT_STATES, Topic


@pytest.mark.parametrize("topic", [JOINT_STATES, COMMAND], ids=lambda each: each.name)
def test_a_second_publisher_is_named(ros: None, capfd: Any, topic: Topic) -> None:
    """By the nodes that receive the topic, again and again."""
    graph = SimulatedGraph(default_settings())
    second = Node("second")
    second.create_publisher(topic.message, topic.name, QOS)
    warnings = ""

    def named() -> bool:
        nonlocal warnings
        warnings += capfd.readouterr().err
        return f"2 nodes publish {topic.name}: " in warnings and "/second" in warnings

    spin_until(graph.executor, named)
    second.destroy_node()
    graph.close()
