"""The nodes that show a rig in RViz, for launch files."""

from typing import NamedTuple

from furuta_description.robot_description import robot_description, share
from furuta_ros.topic_names import full_namespace
from furuta_sim.settings.rigs import find_rig

DEFAULT_RIG = "paper"


class DisplayNode(NamedTuple):
    """A node as ``launch_ros.actions.Node`` starts it."""

    package: str
    executable: str
    namespace: str
    parameters: dict[str, str]
    arguments: list[str]


def display_nodes(rig: str = "", namespace: str = "") -> list[DisplayNode]:
    """The robot state publisher with the description of a rig, and RViz.

    Raises:
        ParameterError: There is no such rig, or the namespace is not valid.
    """
    where = full_namespace(namespace)
    model = find_rig(rig or DEFAULT_RIG).model
    urdf = robot_description(model.arm_length, model.pendulum_length)
    layout = ["-d", str(share("config", "furuta.rviz"))]
    return [
        DisplayNode(
            "robot_state_publisher",
            "robot_state_publisher",
            where,
            {"robot_description": urdf},
            [],
        ),
        DisplayNode("rviz2", "rviz2", where, {}, layout),
    ]
