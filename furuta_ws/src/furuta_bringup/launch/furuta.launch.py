"""The graph, one process per node.

ros2 launch furuta_bringup furuta.launch.py clock:=lockstep params_file:=mine.yaml
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
}


def nodes(context: LaunchContext) -> list[Node]:
    """All nodes with their parameter files; a file that is missing is the node's to refuse."""
    config = Path(get_package_share_directory("furuta_bringup")) / "config"
    extra = LaunchConfiguration("params_file").perform(context)
    clock = LaunchConfiguration("clock").perform(context)
    made = []
    for name, package in NODES.items():
        arguments = ["--params-file", str(config / f"{name}.yaml")]
        if extra:
            arguments += ["--params-file", extra]
        if clock and name == "plant":
            arguments += ["-p", f"clock:={clock}"]
        made.append(
            Node(
                package=package,
                executable=name,
                name=name,
                output="screen",
                ros_arguments=arguments,
                # Without a plant there is nothing to control; the others can be started again.
                on_exit=[Shutdown()] if name == "plant" else None,
            )
        )
    return made


def generate_launch_description() -> LaunchDescription:
    """Launch plant, estimator, friction observer and controller."""
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
            OpaqueFunction(function=nodes),
        ]
    )
