"""``furuta param``: parameters of running nodes, as with ``ros2 param``, and parameter files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from furuta.settings.nodes import NODES
from furuta_bringup.options import HelpfulGroup, joined_node, json_option, namespace_option
from furuta_bringup.printing import print_file, print_json, with_status
from furuta_model.parameters import (
    ParameterError,
    number_from_text,
    number_hint,
    shortened,
    suggestion,
)

if TYPE_CHECKING:
    from furuta_bringup.graph.parameter_client import ParameterClient


@click.group(cls=HelpfulGroup)
def command() -> None:
    """Read and set parameters of running nodes; print parameter files.

    NODE is the name of a node in the namespace given with --namespace, or its full name, such as
    /left/plant.
    """


def _node_name(ctx: click.Context, param: click.Parameter, value: str) -> str:
    if not re.fullmatch(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", value, re.ASCII):
        raise click.BadParameter(f"{value!r} is not a node name such as plant or /left/plant")
    return value


node_argument = click.argument("node", callback=_node_name)


@contextmanager
def _client(node: str, namespace: str, quiet: bool = False) -> Iterator[ParameterClient]:
    with with_status(f"looking for {node}", quiet):
        from furuta_bringup.graph.parameter_client import ParameterClient

        with joined_node("furuta_param", namespace) as joined:
            yield ParameterClient(*joined)


@command.command("list")
@node_argument
@namespace_option
@json_option
def list_(node: str, namespace: str, as_json: bool) -> None:
    """List the parameters of NODE with their values."""
    with _client(node, namespace, as_json) as client:
        values = client.get(node, client.names(node))
    if as_json:
        print_json({name: _plain(value) for name, value in values.items()})
    else:
        for name, value in values.items():
            print(f"{name}: {_plain(value)}")


@command.command()
@node_argument
@click.argument("name")
@namespace_option
@json_option
def get(node: str, name: str, namespace: str, as_json: bool) -> None:
    """Print the value of one parameter."""
    with _client(node, namespace, as_json) as client:
        value = _plain(client.get(node, [name])[name])
    if as_json:
        print_json({name: value})
    else:
        print(value)


# Otherwise the value of `set NODE NAME -0.1` would be taken for an option.
@command.command("set", context_settings={"ignore_unknown_options": True})
@node_argument
@click.argument("assignments", nargs=-1, required=True, metavar="NAME VALUE | NAME=VALUE ...")
@namespace_option
def set_(node: str, assignments: tuple[str, ...], namespace: str) -> None:
    """Set one parameter of NODE, or several: all or none."""
    pairs = (
        [assignments]
        if len(assignments) == 2 and "=" not in assignments[0]
        else [tuple(text.split("=", 1)) for text in assignments]
    )
    if any(len(pair) != 2 or pair[0].startswith("-") for pair in pairs):
        raise click.UsageError("expected NAME VALUE, or NAME=VALUE, such as omega1=7")
    with _client(node, namespace) as client:
        values = {name: _value(client, node, name, text) for name, text in pairs}
        client.set_all(node, values)
    for name, value in values.items():
        print(f"{node}.{name} = {_plain(value)}")


def _value(client: ParameterClient, node: str, name: str, text: str) -> Any:
    """The value with the type of the parameter: ROS would reject 80 for a double.

    The node itself rejects a name that it does not know.
    """
    from rcl_interfaces.msg import ParameterType

    from furuta_ros.yaml_files import parse_yaml

    try:
        value = parse_yaml(text, name)
    except ParameterError:
        raise ParameterError(f"{name}: cannot read the value {text!r}") from None
    types = {described.type for described in client.describe(node, [name])}
    if ParameterType.PARAMETER_DOUBLE in types:
        return _double(name, value)
    if ParameterType.PARAMETER_DOUBLE_ARRAY in types and isinstance(value, list):
        return [_double(name, item) for item in value]
    return value if types else number_from_text(value)


def _double(name: str, value: Any) -> float:
    number = number_from_text(value)
    if isinstance(number, bool) or not isinstance(number, (int, float)):
        raise ParameterError(
            f"{name} must be a number, given {shortened(value)}{number_hint(value)}"
        )
    return float(number)


@command.command()
@click.argument("node", required=False)
def defaults(node: str | None) -> None:
    """Print a parameter file with the defaults of NODE.

    Without NODE it has those of all nodes.
    """
    from furuta_bringup.parameter_files import parameter_file

    if node is not None and node not in NODES:
        raise ParameterError(
            f"no node {node}; nodes are {', '.join(NODES)}{suggestion(node, NODES)}"
        )
    print_file("\n".join(parameter_file(name) for name in ([node] if node else NODES)))


def _plain(value: Any) -> Any:
    return value if isinstance(value, (bool, int, float, str)) else list(value or ())
