"""Names of the graph's topics and joints as plain data, for programs without ROS.

The types and the quality of service of the topics are in ``furuta_ros.topics``.
"""

from typing import Final

JOINTS: Final = ("arm", "pendulum")

MEASUREMENT: Final = "measurement"
JOINT_STATES: Final = "joint_states"
FRICTION_ESTIMATE: Final = "friction_estimate"
COMMAND: Final = "command"
GROUND_TRUTH: Final = "ground_truth"
MODE_IN_FORCE: Final = "mode_in_force"
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
