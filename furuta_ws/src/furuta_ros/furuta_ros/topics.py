"""The graph's contract: topic names, types and quality of service, in one place.

Names are relative, so that a namespace or a remapping moves a whole graph. The loop needs every
sample, so topics are reliable. With a depth of a few samples a slow subscriber gets the newest
ones and does not block the publisher.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, String, UInt64MultiArray

from furuta_model import topic_names

JOINTS = list(topic_names.JOINTS)

QOS = QoSProfile(
    depth=10,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.VOLATILE,
)


def deep(depth: int) -> QoSProfile:
    """The same quality of service with a queue of ``depth`` messages, for a slow subscriber."""
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

# What the controller does, published at its start and when it changes. A late subscriber gets the
# last ones.
MODE_IN_FORCE = Topic(topic_names.MODE_IN_FORCE, String)
LATCHED = QoSProfile(
    depth=QOS.depth,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
)

TOPICS = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND, GROUND_TRUTH)

# How late samples of real time were, once a second, as two rows of counts: the latency from
# measurement to command and the lateness of the measurement. A label says how wide a bin is.
TIMING = Topic(topic_names.TIMING, UInt64MultiArray)

# Simulated time in lock-step. Its name is relative too: two graphs must not mix their times.
CLOCK = Topic(topic_names.CLOCK, Clock)
