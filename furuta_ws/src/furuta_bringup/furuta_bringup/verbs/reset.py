"""``furuta reset``: calls the reset service of a running plant."""

import click

from furuta_bringup.options import json_option, namespace_option
from furuta_bringup.printing import show


@click.command()
@namespace_option
@json_option
def command(namespace: str, as_json: bool) -> None:
    """Put the simulated pendulum upright again; estimator and friction observer start anew."""
    from rclpy.node import Node

    from furuta_graph.services import ServiceCaller
    from furuta_graph.system_client import reset_plant
    from furuta_ros.context import joined_graph
    from furuta_ros.spinning import executor_of

    with joined_graph(namespace):
        node = Node("furuta_reset", start_parameter_services=False)
        message = reset_plant(ServiceCaller(node, executor_of([node])))
    show({"message": message}, as_json)
