"""The graph's contract: topic names, types and quality of service, in one place.

Names are relative, so that a namespace or a remapping moves a whole graph. Every sample matters
to the loop, so topics are reliable; a depth of a few samples lets a slow reader see the newest
ones without holding anybody up.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, UInt64MultiArray

from furuta_model import topic_names

JOINTS = list(topic_names.JOINTS)

QOS = QoSProfile(
    depth=10,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.VOLATILE,
)


def deep(depth: int) -> QoSProfile:
    """The same for a subscriber that may lag behind by ``depth`` messages without losing any."""
    return QoSProfile(depth=depth, reliability=QOS.reliability, durability=QOS.durability)


class Topic(NamedTuple):
    """A topic of the graph."""

    name: str
    type: Any


MEASUREMENT = Topic(topic_names.MEASUREMENT, JointState)
JOINT_STATES = Topic(topic_names.JOINT_STATES, JointState)
FRICTION_ESTIMATE = Topic(topic_names.FRICTION_ESTIMATE, Float64)
COMMAND = Topic(topic_names.COMMAND, Float64)
GROUND_TRUTH = Topic(topic_names.GROUND_TRUTH, JointState)

TOPICS = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND, GROUND_TRUTH)

# How late samples of real time were, once a second, as two rows of counts: the latency from
# measurement to command and the lateness of the measurement. A label says how wide a bin is.
TIMING = Topic(topic_names.TIMING, UInt64MultiArray)
