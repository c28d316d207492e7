"""The graph's contract: topic names, types and quality of service, in one place.

Names are relative, so that a namespace or a remapping moves a whole graph. The loop needs every
sample, so topics are reliable. With a depth of a few samples a slow subscriber gets the newest
ones and does not block the publisher.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String, UInt64MultiArray

from furuta_ros import topic_names

JOINTS = list(topic_names.JOINTS)

QOS = QoSProfile(
    depth=10,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.VOLATILE,
)

# Robots publish their states either way; a best-effort subscriber receives both.
BEST_EFFORT = QoSProfile(depth=10, reliability=QoSReliabilityPolicy.BEST_EFFORT)


def deep(depth: int) -> QoSProfile:
    """The same quality of service with a queue of ``depth`` messages, for a slow subscriber."""
    return QoSProfile(depth=depth, reliability=QOS.reliability, durability=QOS.durability)


class Topic(NamedTuple):
    """A topic of the graph: name, type, who publishes it for whom, and what it contains."""

    name: str
    type: Any
    ends: str = ""
    content: str = ""

    @property
    def throttled(self) -> Topic:
        """The topic with some of these messages, for programs that draw."""
        publisher = self.ends.partition(" →")[0]
        return Topic(
            self.name + topic_names.THROTTLED,
            self.type,
            f"{publisher} → programs that draw",
            f"about 100 messages of `{self.name}` per second of the loop's time",
        )


MEASUREMENT = Topic(
    topic_names.MEASUREMENT,
    JointState,
    "plant → estimator",
    "sensor readings, NaN where there is no sensor; `effort[0]` is the torque applied since the "
    "previous sample [V]",
)
JOINT_STATES = Topic(
    topic_names.JOINT_STATES,
    JointState,
    "estimator → observer, controller",
    "state estimate; `effort[0]` is the observed friction [V]",
)
REFERENCE = Topic(
    topic_names.REFERENCE,
    JointState,
    "trajectory generator → observer of a joint",
    "velocity that the joint is to have",
)
FRICTION_ESTIMATE = Topic(
    topic_names.FRICTION_ESTIMATE, Float64, "friction observer → controller", "F̂ [V]"
)
COMMAND = Topic(topic_names.COMMAND, Float64, "controller → plant", "u [V], saturated")
GROUND_TRUTH = Topic(
    topic_names.GROUND_TRUTH,
    JointState,
    "plant → any subscriber",
    "true state; `effort[0]` is the true friction F [V]; published while somebody subscribes",
)

# A late subscriber gets the last ones.
ACTIVE_MODE = Topic(
    topic_names.ACTIVE_MODE,
    String,
    "controller → any subscriber",
    "what the controller does, sent when that changes; transient local",
)
ARMED = Topic(
    topic_names.ARMED,
    Bool,
    "hardware bridge → controller",
    "whether the rig applies commands, sent when that changes; transient local",
)
LATCHED = QoSProfile(
    depth=QOS.depth,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
)

TOPICS = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND, GROUND_TRUTH)

# These have a throttled copy each: about a hundred messages per second of the loop's time.
THROTTLED_TOPICS = (JOINT_STATES, FRICTION_ESTIMATE, COMMAND, GROUND_TRUTH)

# Two rows of counts: the latency from measurement to command and the lateness of the measurement.
# A label says how wide a bin is.
TIMING = Topic(
    topic_names.TIMING,
    UInt64MultiArray,
    "plant → any subscriber",
    "histograms of latency and lateness in real time, once a second",
)

# Its name is relative too: two graphs must not mix their times.
CLOCK = Topic(
    topic_names.CLOCK,
    Clock,
    "plant → nodes with `use_sim_time`",
    "simulated time in lock-step",
)

# Every ROS 2 program for robots publishes its state here; the bridge does so for the rig.
DIAGNOSTICS = Topic("/diagnostics", DiagnosticArray)

# Every topic that the nodes of the graph publish.
EVERY_TOPIC = (*TOPICS, ACTIVE_MODE, ARMED, CLOCK, TIMING)
