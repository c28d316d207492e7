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
    """A topic of the graph: name, type, who publishes it for whom, and what it contains."""

    name: str
    type: str
    ends: str = ""
    content: str = ""

    @property
    def message(self) -> Any:
        """The class of its messages."""
        package, _, name = self.type.partition("/msg/")
        return getattr(import_module(f"{package}.msg"), name)

    @property
    def throttled(self) -> Topic:
        """About 100 of these messages per second of the loop's time, for programs that draw."""
        return Topic(f"{self.name}_throttle", self.type)


MEASUREMENT = Topic(
    "measurement",
    JOINT_STATE,
    "plant → estimator",
    "sensor readings, NaN where there is no sensor; `effort[0]` is the torque applied since the "
    "previous sample [V]",
)
JOINT_STATES = Topic(
    "joint_states",
    JOINT_STATE,
    "estimator → observer, controller",
    "state estimate; `effort[0]` is the observed friction [V]",
)
REFERENCE = Topic(
    "reference",
    JOINT_STATE,
    "trajectory generator → observer of a joint",
    "velocity that the joint is to have",
)
FRICTION_ESTIMATE = Topic("friction_estimate", FLOAT64, "friction observer → controller", "F̂ [V]")
COMMAND = Topic("command", FLOAT64, "controller → plant", "u [V], saturated")
GROUND_TRUTH = Topic(
    "ground_truth",
    JOINT_STATE,
    "plant → any subscriber",
    "true state; `effort[0]` is the true friction F [V]; published while somebody subscribes",
)

# A late subscriber gets the last ones.
ACTIVE_MODE = Topic(
    "active_mode",
    "std_msgs/msg/String",
    "controller → any subscriber",
    "what the controller does, sent when that changes; transient local",
)
ARMED = Topic(
    "armed",
    "std_msgs/msg/Bool",
    "hardware bridge → controller",
    "whether the rig applies commands, sent when that changes; transient local",
)

TOPICS = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND, GROUND_TRUTH)

# Two rows of counts: the latency from measurement to command and the lateness of the measurement.
# A label says how wide a bin is.
TIMING = Topic(
    "timing",
    "std_msgs/msg/UInt64MultiArray",
    "plant → any subscriber",
    "histograms of latency and lateness in real time, once a second",
)

# Its name is relative too: two graphs must not mix their times.
CLOCK = Topic(
    "clock",
    "rosgraph_msgs/msg/Clock",
    "plant → nodes with `use_sim_time`",
    "simulated time in lock-step",
)

# Every ROS 2 program for robots publishes its state here; the bridge does so for the rig.
DIAGNOSTICS = Topic("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")

# Every ROS 2 node reports its parameter changes on one and its log messages on the other.
PARAMETER_EVENTS = Topic("/parameter_events", "rcl_interfaces/msg/ParameterEvent")
ROSOUT = Topic("/rosout", "rcl_interfaces/msg/Log")
