"""The graph, one process per node, as ``furuta run --processes`` starts it.

ros2 launch furuta_bringup furuta.launch.py clock:=lockstep params_file:=mine.yaml
ros2 launch furuta_bringup furuta.launch.py port:=/dev/ttyACM0 rig:=/path/to/rig.yaml
ros2 launch furuta_bringup furuta.launch.py namespace:=left
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from furuta_graph.launching import launched_processes
from launch import LaunchContext, LaunchDescription

# Arguments and their descriptions; all are empty by default.
ARGUMENTS = {
    "clock": "realtime or lockstep; empty: that of the parameter files",
    "params_file": "parameter file; takes precedence over the rig and the installed files",
    "port": "serial port of a rig that replaces the simulated plant; it is armed by hand",
    "rig": "name or file of the rig, for every node; empty: the paper's rig",
    "namespace": "namespace of all nodes, to run several graphs side by side",
    "without": "nodes to leave out, separated by commas, to run your own instead",
}


def nodes(context: LaunchContext) -> list[Node]:
    """All nodes with their parameters; a wrong argument raises an error and starts none."""
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    controlled, *others = launched_processes(**given)
    return [
        # Without it there is nothing to control; the others can be started again.
        _node(controlled, on_exit=[Shutdown()]),
        *(_node(each) for each in others),
    ]


def _node(process, **options) -> Node:
    return Node(
        package=process.package,
        executable=process.executable,
        name=process.name,
        namespace=process.namespace or None,
        output="screen",
        ros_arguments=process.parameter_arguments,
        **options,
    )


def generate_launch_description() -> LaunchDescription:
    """Launch plant or bridge, estimator, friction observer and controller."""
    arguments = (
        DeclareLaunchArgument(name, default_value="", description=description)
        for name, description in ARGUMENTS.items()
    )
    return LaunchDescription([*arguments, OpaqueFunction(function=nodes)])
