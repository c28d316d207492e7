"""The graph's contract: topic names, types and quality of service, in one place.

Names are relative, so that a namespace or a remapping moves a whole graph. The loop needs every
sample, so topics are reliable. With a depth of a few samples a slow subscriber gets the newest
ones and does not block the publisher.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, UInt64MultiArray

JOINTS = ["arm", "pendulum"]

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


MEASUREMENT = Topic("measurement", JointState)
JOINT_STATES = Topic("joint_states", JointState)
FRICTION_ESTIMATE = Topic("friction_estimate", Float64)
COMMAND = Topic("command", Float64)
GROUND_TRUTH = Topic("ground_truth", JointState)

TOPICS = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND, GROUND_TRUTH)

# Histograms of how late samples were in real time, once a second, as two rows of counts: latency
# from measurement to command and lateness of the measurement. A label gives the width of a bin.
TIMING = Topic("timing", UInt64MultiArray)
