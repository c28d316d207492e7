"""RViz with the robot description of a rig, beside a running graph.

ros2 launch furuta_description display.launch.py rig:=paper namespace:=left use_sim_time:=true
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from furuta_description.robot_description import display_nodes
from furuta_model.parameters import ParameterError
from launch import LaunchContext, LaunchDescription

ARGUMENTS = {
    "rig": ("", "name or file of the rig that is shown; empty: the paper's rig"),
    "namespace": ("", "namespace of the graph"),
    "use_sim_time": ("false", "true or false: follow the graph's clock, in lock-step"),
}


def nodes(context: LaunchContext) -> list[Node]:
    """The nodes; a wrong argument raises an error and starts none."""
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    lockstep = {"true": True, "false": False}.get(given.pop("use_sim_time").lower())
    if lockstep is None:
        raise ParameterError("use_sim_time must be true or false")
    return [Node(**arguments) for arguments in display_nodes(**given, lockstep=lockstep)]


def generate_launch_description() -> LaunchDescription:
    """Launch the robot state publisher and RViz."""
    arguments = (
        DeclareLaunchArgument(name, default_value=default, description=description)
        for name, (default, description) in ARGUMENTS.items()
    )
    return LaunchDescription([*arguments, OpaqueFunction(function=nodes)])
