"""The robot description (URDF) of a rig from its lengths, and the nodes that show it in RViz."""

from pathlib import Path
from typing import Any

from furuta_hw.rigs.known_rigs import find_rig
from furuta_model.optional import needed_by
from furuta_ros.installed_files import share_directory
from furuta_ros.one_graph import full_namespace

PACKAGE = "furuta_description"
DEFAULT_RIG = "paper"


def share(folder: str, name: str) -> Path:
    """An installed file of this package."""
    return share_directory(PACKAGE) / folder / name


def robot_description(arm_length: float, pendulum_length: float) -> str:
    """The URDF of a pendulum with these lengths [m].

    Raises:
        ModuleNotFoundError: xacro is not installed.
    """
    with needed_by("the view in RViz"):
        import xacro  # noqa: PLC0415 - a graph without a view does not need it

    given = {"arm_length": f"{arm_length:.6g}", "pendulum_length": f"{pendulum_length:.6g}"}
    document = xacro.process_file(str(share("urdf", "furuta.urdf.xacro")), mappings=given)
    return str(document.toxml())


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
