"""The graph, one process per node.

ros2 launch furuta_bringup furuta.launch.py clock:=lockstep params_file:=mine.yaml
"""

from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

from launch import LaunchDescription

NODES = {
    "plant": "furuta_sim",
    "estimator": "furuta_control",
    "friction_observer": "furuta_friction",
    "controller": "furuta_control",
}


def generate_launch_description() -> LaunchDescription:
    """Launch plant, estimator, friction observer and controller with their parameter files."""
    config = PathJoinSubstitution([FindPackageShare("furuta_bringup"), "config"])
    nodes = [
        Node(
            package=package,
            executable=name,
            name=name,
            output="screen",
            parameters=[
                PathJoinSubstitution([config, f"{name}.yaml"]),
                LaunchConfiguration("params_file"),
                *([{"clock": LaunchConfiguration("clock")}] if name == "plant" else []),
            ],
        )
        for name, package in NODES.items()
    ]
    return LaunchDescription(
        [
            DeclareLaunchArgument("clock", default_value="realtime", description="or lockstep"),
            DeclareLaunchArgument(
                "params_file",
                default_value=PathJoinSubstitution([config, "plant.yaml"]),
                description="parameter file laid over the defaults",
            ),
            *nodes,
        ]
    )
