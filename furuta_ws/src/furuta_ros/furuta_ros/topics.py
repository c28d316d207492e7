"""The graph's contract: joints, topics with their types, transitions of the bridge. Needs no ROS.

Names are relative, so that a namespace or a remapping moves a whole graph.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, Final, NamedTuple

JOINTS: Final = ("arm", "pendulum")
JOINT_STATE: Final = "sensor_msgs/msg/JointState"
FLOAT64: Final = "std_msgs/msg/Float64"

# Transitions of the managed bridge by name, each with the state after it.
TRANSITIONS: Final = {
    "configure": "inactive",
    "activate": "active",
    "deactivate": "inactive",
    "cleanup": "unconfigured",
}


class Topic(NamedTuple):
    """A topic of the graph (docs/topics.md)."""

    name: str
    type: str

    @property
    def message(self) -> Any:
        """The class of its messages."""
        package, _, name = self.type.partition("/msg/")
        return getattr(import_module(f"{package}.msg"), name)

    @property
    def throttled(self) -> Topic:
        """About 100 of these messages per second of the loop's time, for programs that draw."""
        return Topic(f"{self.name}_throttle", self.type)


# Sensor readings, NaN without a sensor. Effort of the arm: the torque applied since the previous
# sample [V].
MEASUREMENT = Topic("measurement", JOINT_STATE)
# Effort of the arm: as measured, the torque applied since the previous sample [V].
JOINT_STATES = Topic("joint_states", JOINT_STATE)
# The velocity that a robot's joint is to have.
REFERENCE = Topic("reference", JOINT_STATE)
FRICTION_ESTIMATE = Topic("friction_estimate", FLOAT64)
COMMAND = Topic("command", FLOAT64)
# Effort of the arm: the true friction F [V]. Published while somebody subscribes.
GROUND_TRUTH = Topic("ground_truth", JOINT_STATE)
# The state in which a motion of the simulated rig begins, sent at each reset; its stamp is that of
# the first sample. A late subscriber gets the last one.
INITIAL_STATE = Topic("initial_state", JOINT_STATE)
TOPICS = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND, GROUND_TRUTH)

# What the controller does, and whether a rig applies its commands. Sent when that changes; a late
# subscriber gets the last ones.
ACTIVE_MODE = Topic("active_mode", "std_msgs/msg/String")
ARMED = Topic("armed", "std_msgs/msg/Bool")

# Two rows of counts: the latency from measurement to command and the lateness of the measurement.
# A label says how wide a bin is.
TIMING = Topic("timing", "std_msgs/msg/UInt64MultiArray")

# Simulated time. Its name is relative too: two graphs must not mix their times.
CLOCK = Topic("clock", "rosgraph_msgs/msg/Clock")

# Every ROS 2 program for robots publishes its state here; the bridge does so for the rig.
DIAGNOSTICS = Topic("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")

# Every ROS 2 node reports its parameter changes on one and its log messages on the other.
PARAMETER_EVENTS = Topic("/parameter_events", "rcl_interfaces/msg/ParameterEvent")
ROSOUT = Topic("/rosout", "rcl_interfaces/msg/Log")
