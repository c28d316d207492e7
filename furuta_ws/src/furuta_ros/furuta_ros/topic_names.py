"""Names of topics, joints and transitions of the graph as plain data, for programs without ROS.

The types and the quality of service of the topics are in ``furuta_ros.topics``.
"""

import re
from typing import Final

from furuta_model.parameters import ParameterError

JOINTS: Final = ("arm", "pendulum")

MEASUREMENT: Final = "measurement"
JOINT_STATES: Final = "joint_states"
REFERENCE: Final = "reference"
FRICTION_ESTIMATE: Final = "friction_estimate"
COMMAND: Final = "command"
GROUND_TRUTH: Final = "ground_truth"
ACTIVE_MODE: Final = "active_mode"
ARMED: Final = "armed"
TIMING: Final = "timing"
# After the name of a topic: its throttled copy, as topic_tools names it.
THROTTLED: Final = "_throttle"
# Simulated time.
CLOCK: Final = "clock"
# Every ROS 2 node reports its parameter changes here.
PARAMETER_EVENTS: Final = "/parameter_events"
# Every ROS 2 node publishes its log messages here.
ROSOUT: Final = "/rosout"

# Transitions of the managed bridge by name, each with the state after it.
TRANSITIONS = {
    "configure": "inactive",
    "activate": "active",
    "deactivate": "inactive",
    "cleanup": "unconfigured",
}


def full_namespace(name: str) -> str:
    """The namespace with its leading slash, or empty; raises ParameterError if it is not valid."""
    bare = name.strip("/")
    if not bare:
        return ""
    if not re.fullmatch(r"[A-Za-z_]\w*(/[A-Za-z_]\w*)*", bare, re.ASCII):
        raise ParameterError(
            f"a namespace has letters, digits and _, and no digit first, given {name!r}"
        )
    return f"/{bare}"
