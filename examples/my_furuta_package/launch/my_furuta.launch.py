"""The graph with my friction observer in place of the original one."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch.actions import IncludeLaunchDescription
from launch_ros.actions import Node

from launch import LaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Launch all nodes with the parameters of my file."""
    graph = Path(get_package_share_directory("furuta_bringup"), "launch", "furuta.launch.py")
    mine = Path(get_package_share_directory("my_furuta_package"), "config", "my_furuta.yaml")
    arguments = {"without": "friction_observer", "params_file": str(mine), "clock": "lockstep"}
    return LaunchDescription(
        [
            IncludeLaunchDescription(str(graph), launch_arguments=arguments.items()),
            Node(
                package="my_furuta_package",
                executable="my_observer",
                name="friction_observer",
                parameters=[str(mine)],
                output="screen",
            ),
        ]
    )
