"""The nodes that show a rig in RViz, for launch files."""

from typing import Any

from furuta_description.robot_description import robot_description, share
from furuta_ros.topic_names import full_namespace
from furuta_sim.settings.rigs import find_rig

DEFAULT_RIG = "paper"


def display_nodes(rig: str = "", namespace: str = "") -> list[dict[str, Any]]:
    """The robot state publisher with the description of a rig, and RViz.

    Each is given as arguments of ``launch_ros.actions.Node``.

    Raises:
        ParameterError: There is no such rig, or the namespace is not valid.
    """
    where = full_namespace(namespace) or None
    model = find_rig(rig or DEFAULT_RIG).model
    urdf = robot_description(model.arm_length, model.pendulum_length)
    named: dict[str, dict[str, Any]] = {
        "robot_state_publisher": {"parameters": [{"robot_description": urdf}]},
        "rviz2": {"arguments": ["-d", str(share("config", "furuta.rviz"))]},
    }
    return [
        {"package": name, "executable": name, "name": name, "namespace": where, **given}
        for name, given in named.items()
    ]
