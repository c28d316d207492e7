"""Who publishes the topics of the loop, and who is missing."""

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from furuta_ros.one_publisher import TopicPublisher
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, JOINT_STATES, MEASUREMENT, Topic

# rclpy's name for a node that is not known yet.
UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"


def publishers_of(node: Node, topic: Topic) -> list[TopicPublisher]:
    """The publishers of a topic that ``node`` knows."""
    endpoints = node.get_publishers_info_by_topic(node.resolve_topic_name(topic.name))
    return [TopicPublisher(bytes(end.endpoint_gid), _node_name(end)) for end in endpoints]


def missing_from_loop(plant: Node) -> list[str]:
    """What the loop lacks besides ``plant``, one clause for each topic."""
    own = plant.resolve_topic_name(MEASUREMENT.name)
    unheard = [] if plant.count_subscribers(own) else [f"no node subscribes to {own}"]
    names = [plant.resolve_topic_name(t.name) for t in (JOINT_STATES, FRICTION_ESTIMATE, COMMAND)]
    return unheard + [
        f"no node publishes {name}" for name in names if not plant.count_publishers(name)
    ]


def _node_name(endpoint: TopicEndpointInfo) -> str:
    if endpoint.node_name == UNKNOWN_NODE:
        return "a node of unknown name"
    return f"{endpoint.node_namespace.rstrip('/')}/{endpoint.node_name}"
