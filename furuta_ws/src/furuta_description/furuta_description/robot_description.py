"""The robot description (URDF) of a rig, and the nodes that show it in RViz."""

from pathlib import Path
from typing import Any

from furuta_hw.rigs.known_rigs import find_rig
from furuta_hw.rigs.rig import Rig
from furuta_model.optional import needed_by
from furuta_ros.installed_files import share_directory
from furuta_ros.one_graph import full_namespace

PACKAGE = "furuta_description"
DEFAULT_RIG = "paper"
ROOT = "base_link"
# Topics that are global in ROS; a graph in a namespace has its own.
OWN_TOPICS = ("tf", "tf_static", "clock")


def share(folder: str, name: str) -> Path:
    """An installed file of this package."""
    return share_directory(PACKAGE) / folder / name


def robot_description(rig: Rig, prefix: str = "", joint_prefix: str | None = None) -> str:
    """The URDF of a rig without its friction: visible shapes, masses [kg] and inertias [kg m²].

    It moves as eq. (1). A torque [N m] is ``rig.drive.torque_per_volt`` times the voltage; masses
    are right where that is.

    Args:
        rig: The rig.
        prefix: Begins the names of all links.
        joint_prefix: Begins the names of all joints; ``None``: ``prefix``.

    Raises:
        ModuleNotFoundError: xacro is not installed.
    """
    with needed_by("the robot description"):
        import xacro  # noqa: PLC0415 - a graph without a view does not need it

    limits = {"voltage": rig.limits.voltage, "arm_speed": rig.limits.arm_speed}
    numbers = rig.model._asdict() | limits | {"torque_per_volt": rig.drive.torque_per_volt}
    given = {name: repr(float(number)) for name, number in numbers.items()}
    given |= {"prefix": prefix, "joint_prefix": prefix if joint_prefix is None else joint_prefix}
    document = xacro.process_file(str(share("urdf", "furuta.urdf.xacro")), mappings=given)
    torque = f"<!-- A voltage of 1 V is a torque of {rig.drive.torque_per_volt:g} N m. -->"
    robot = document.documentElement.toprettyxml(indent="  ")
    return f'<?xml version="1.0"?>\n{torque}\n{robot}'


def display_nodes(
    rig: str = "", namespace: str = "", lockstep: bool = False
) -> list[dict[str, Any]]:
    """The robot state publisher with the description of a rig, and RViz.

    Each is given as arguments of ``launch_ros.actions.Node``. In a namespace they have transforms
    and time of their own, and frames whose names begin with the namespace.

    Args:
        rig: Name or file of the rig; empty: the paper's rig.
        namespace: Namespace of the graph.
        lockstep: Follow the simulated time of the graph.

    Raises:
        ParameterError: There is no such rig, or the namespace is not valid.
    """
    where = full_namespace(namespace)
    prefix = where.strip("/").replace("/", "_") + "_" if where else ""
    urdf = robot_description(find_rig(rig or DEFAULT_RIG), prefix, joint_prefix="")
    layout = str(share("config", "furuta.rviz"))
    named: dict[str, dict[str, Any]] = {
        "robot_state_publisher": {"parameters": [{"robot_description": urdf}]},
        "rviz2": {"parameters": [{}], "arguments": ["-d", layout, "-f", f"{prefix}{ROOT}"]},
    }
    for given in named.values():
        given["parameters"][0]["use_sim_time"] = lockstep
    shared = {"namespace": where or None, "remappings": [(f"/{name}", name) for name in OWN_TOPICS]}
    return [
        {"package": name, "executable": name, "name": name, **shared, **given}
        for name, given in named.items()
    ]
