"""The graph, one process per node.

ros2 launch furuta_bringup furuta.launch.py clock:=lockstep params_file:=mine.yaml
ros2 launch furuta_bringup furuta.launch.py port:=/dev/ttyACM0 rig:=/path/to/rig.yaml
"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription

NODES = {
    "plant": "furuta_sim",
    "estimator": "furuta_control",
    "friction_observer": "furuta_friction",
    "controller": "furuta_control",
    "hardware_bridge": "furuta_hw",
}


def nodes(context: LaunchContext) -> list[Node]:
    """All nodes with their parameter files; a file that is missing is the node's to refuse."""
    config = Path(get_package_share_directory("furuta_bringup")) / "config"
    extra = LaunchConfiguration("params_file").perform(context)
    clock = LaunchConfiguration("clock").perform(context)
    port = LaunchConfiguration("port").perform(context)
    rig = LaunchConfiguration("rig").perform(context)
    controlled, other = ("hardware_bridge", "plant") if port else ("plant", "hardware_bridge")
    made = []
    for name, package in NODES.items():
        if name == other:
            continue
        arguments = ["--params-file", str(config / f"{name}.yaml")]
        if extra:
            arguments += ["--params-file", extra]
        if clock and name == "plant":
            arguments += ["-p", f"clock:={clock}"]
        if name == "hardware_bridge":
            arguments += ["-p", f"port:={port}", "-p", "autostart:=active"]
            arguments += ["-p", f"rig:={rig}"] if rig else []
        made.append(
            Node(
                package=package,
                executable=name,
                name=name,
                output="screen",
                ros_arguments=arguments,
                # Without it there is nothing to control; the others can be started again.
                on_exit=[Shutdown()] if name == controlled else None,
            )
        )
    return made


def generate_launch_description() -> LaunchDescription:
    """Launch plant or bridge, estimator, friction observer and controller."""
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "clock",
                default_value="",
                choices=["", "realtime", "lockstep"],
                description="how the plant's time runs; empty: as the parameter files say",
            ),
            DeclareLaunchArgument(
                "params_file",
                default_value="",
                description="parameter file laid over the defaults",
            ),
            DeclareLaunchArgument(
                "port",
                default_value="",
                description="serial port of a rig, in the plant's place; it is armed by hand",
            ),
            DeclareLaunchArgument(
                "rig", default_value="", description="path of the rig file; empty: the paper's rig"
            ),
            OpaqueFunction(function=nodes),
        ]
    )
