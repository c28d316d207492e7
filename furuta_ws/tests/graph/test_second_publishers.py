"""Second publishers on the topics of the composed graph: they are named."""

from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.node import Node

from furuta.settings.settings import default_settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_friction.friction_observer_node import FrictionObserverNode
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


@pytest.mark.parametrize("number", [1, 2])
def test_a_publisher_that_is_discovered_before_its_node(
    ros: None, monkeypatch: Any, number: int
) -> None:
    """It is counted, but not named as ROS fills in, nor taken for a node that runs twice."""
    node = FrictionObserverNode()
    known = SimpleNamespace(node_namespace="/left", node_name="controller")
    unknown = SimpleNamespace(
        node_namespace="_NODE_NAMESPACE_UNKNOWN_", node_name="_NODE_NAME_UNKNOWN_"
    )
    ends = [unknown] * number + [known]
    monkeypatch.setattr(node, "count_publishers", lambda name: len(ends))
    monkeypatch.setattr(node, "get_publishers_info_by_topic", lambda name: ends)
    others = " and a node whose name is not known yet" * number
    text = f"{1 + number} nodes publish command: /left/controller{others}"
    assert node.second_publishers([COMMAND]) == text
    node.destroy_node()
