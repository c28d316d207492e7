"""The graph, one process per node, as ``furuta run --processes`` starts it.

ros2 launch furuta_bringup furuta.launch.py clock:=lockstep params_file:=mine.yaml
ros2 launch furuta_bringup furuta.launch.py port:=/dev/ttyACM0 rig:=/path/to/rig.yaml
ros2 launch furuta_bringup furuta.launch.py namespace:=left compensation:=lugre record:=output/bag
ros2 launch furuta_bringup furuta.launch.py --show-args
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from furuta_bringup.launching import LOG_LEVELS, launched_nodes
from launch import LaunchContext, LaunchDescription

# Arguments with their defaults and descriptions.
ARGUMENTS = {
    "clock": ("", "realtime or lockstep; empty: that of the parameter files"),
    "params_file": ("", "parameter file; takes precedence over the rig and the installed files"),
    "port": ("", "serial port of a rig that replaces the simulated plant; it is armed by hand"),
    "rig": ("", "name or file of the rig, for every node; empty: the paper's rig"),
    "namespace": ("", "namespace of all nodes, to run several graphs side by side"),
    "without": ("", "nodes to leave out, separated by commas, to run your own instead"),
    "compensation": ("", "friction compensation, such as lugre; empty: as the parameter files say"),
    "record": ("", "directory for a bag of all topics, which must not exist; empty: no bag"),
    "own_parts": ("", "parts of your own to accept, module:function, separated by commas"),
    "log_level": ("info", f"lowest level that all nodes log: {', '.join(LOG_LEVELS)}"),
    "respawn": (
        "false",
        "true or false: start estimator, friction observer and controller again when they end; "
        "the launch ends with the plant or the bridge",
    ),
    "view": ("false", "true or false: show the rig in RViz"),
}


def nodes(context: LaunchContext) -> list[Node]:
    """All nodes with their parameters; a wrong argument raises an error and starts none."""
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    controlled, *others = launched_nodes(**given)
    return [Node(**controlled, on_exit=[Shutdown()]), *(Node(**node) for node in others)]


def generate_launch_description() -> LaunchDescription:
    """Launch the graph, and a recorder if one is asked for."""
    arguments = (
        DeclareLaunchArgument(name, default_value=default, description=description)
        for name, (default, description) in ARGUMENTS.items()
    )
    return LaunchDescription([*arguments, OpaqueFunction(function=nodes)])
