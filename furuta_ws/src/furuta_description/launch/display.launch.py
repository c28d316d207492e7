"""RViz with the robot description of a rig, beside a running graph.

ros2 launch furuta_description display.launch.py rig:=qube_servo_2 namespace:=left
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from furuta_description.robot_description import display_nodes
from launch import LaunchContext, LaunchDescription

ARGUMENTS = {
    "rig": "name or file of the rig whose lengths are shown; empty: the paper's rig",
    "namespace": "namespace of the graph",
}


def nodes(context: LaunchContext) -> list[Node]:
    """The nodes; a wrong argument raises an error and starts none."""
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    return [Node(**arguments) for arguments in display_nodes(**given)]


def generate_launch_description() -> LaunchDescription:
    """Launch the robot state publisher and RViz."""
    arguments = (
        DeclareLaunchArgument(name, default_value="", description=description)
        for name, description in ARGUMENTS.items()
    )
    return LaunchDescription([*arguments, OpaqueFunction(function=nodes)])
