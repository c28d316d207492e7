"""``furuta param``: what ``ros2 param`` does, where that is not installed; and parameter files."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import click
import rclpy
import yaml
from rcl_interfaces.msg import ParameterType
from rclpy.node import Node

from furuta_cli.options import json_option, print_json
from furuta_graph.parameter_client import ParameterClient
from furuta_graph.parameter_files import parameter_file, parameter_table
from furuta_graph.settings import NODES
from furuta_model.parameters import ParameterError
from furuta_ros.spinning import executor_of


@click.group()
def command() -> None:
    """Read and set parameters of running nodes; print parameter files."""


@contextmanager
def _client() -> Iterator[ParameterClient]:
    rclpy.init(args=[])
    try:
        node = Node("furuta_param")
        yield ParameterClient(node, executor_of([node]))
    finally:
        rclpy.try_shutdown()


@command.command("list")
@click.argument("node")
@json_option
def list_(node: str, as_json: bool) -> None:
    """List the parameters of NODE with their values."""
    with _client() as client:
        values = client.get(node, client.names(node))
    if as_json:
        print_json({name: _plain(value) for name, value in values.items()})
    else:
        for name, value in values.items():
            print(f"{name}: {_plain(value)}")


@command.command()
@click.argument("node")
@click.argument("name")
@json_option
def get(node: str, name: str, as_json: bool) -> None:
    """Print the value of one parameter."""
    with _client() as client:
        value = _plain(client.get(node, [name])[name])
    if as_json:
        print_json({name: value})
    else:
        print(value)


@command.command("set")
@click.argument("node")
@click.argument("assignments", nargs=-1, required=True, metavar="NAME VALUE | NAME=VALUE ...")
def set_(node: str, assignments: tuple[str, ...]) -> None:
    """Set parameters of NODE: one as NAME VALUE, or several at once as NAME=VALUE, all or none."""
    pairs = (
        [assignments]
        if len(assignments) == 2 and "=" not in assignments[0]
        else [tuple(each.split("=", 1)) for each in assignments]
    )
    if any(len(pair) != 2 for pair in pairs):
        raise click.UsageError("expected NAME VALUE, or NAME=VALUE ...")
    with _client() as client:
        names = [name for name, _ in pairs]
        values = {}
        for (name, text), about in zip(pairs, client.describe(node, names), strict=True):
            value = yaml.safe_load(text)
            # 80 is a fine value for a parameter of type double, whatever ROS thinks of it.
            if about.type == ParameterType.PARAMETER_DOUBLE and isinstance(value, (int, str)):
                value = _number(value)
            if about.type == ParameterType.PARAMETER_DOUBLE_ARRAY and isinstance(value, list):
                value = [float(each) for each in value]
            values[name] = value
        client.set_all(node, values)


def _number(value: int | str) -> float | int | str:
    try:
        return value if isinstance(value, bool) else float(value)
    except ValueError:
        return value


@command.command()
@click.argument("node", required=False)
@click.option("--markdown", is_flag=True, help="A table instead of a parameter file.")
def defaults(node: str | None, markdown: bool) -> None:
    """Print a parameter file with the defaults of NODE, or of all nodes."""
    if node is not None and node not in NODES:
        raise ParameterError(f"no node {node}; nodes are {', '.join(NODES)}")
    render = parameter_table if markdown else parameter_file
    print("\n".join(render(each) for each in ([node] if node else NODES)), end="")


def _plain(value: Any) -> Any:
    return value if isinstance(value, (bool, int, float, str)) else list(value or ())
