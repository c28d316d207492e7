"""``furuta node``: lists and runs nodes, as ``ros2 node`` and ``ros2 run`` do."""

import os

import click

from furuta_bringup.groups import HelpfulGroup
from furuta_bringup.options import json_option
from furuta_bringup.printing import print_json

# Discovery of a running graph can take this long [s].
DISCOVERY = 3.0


@click.group(cls=HelpfulGroup)
def command() -> None:
    """List the running nodes, or run one."""


@command.command("list")
@json_option
def list_(as_json: bool) -> None:
    """List the running nodes."""
    from rclpy.node import Node

    from furuta_ros.context import ros_context
    from furuta_ros.spinning import executor_of, spin_until

    with ros_context():
        node = Node("furuta_node_list", start_parameter_services=False)
        end = node.get_clock().now().nanoseconds + int(DISCOVERY * 1e9)
        spin_until(executor_of([node]), lambda: node.get_clock().now().nanoseconds > end)
        names = sorted(
            f"{namespace.rstrip('/')}/{name}"
            for name, namespace in node.get_node_names_and_namespaces()
            if name != node.get_name()
        )
    if as_json:
        print_json({"nodes": names})
    else:
        print("\n".join(names) or "no node is running")


@command.command(context_settings={"ignore_unknown_options": True})
@click.argument("package")
@click.argument("executable")
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def run(package: str, executable: str, arguments: tuple[str, ...]) -> None:
    """Run EXECUTABLE of PACKAGE.

    Example: furuta node run furuta_sim plant --ros-args -p seed:=1
    """
    from furuta_graph.processes import executable as find

    path = find(package, executable)
    os.execv(path, [str(path), *arguments])
