"""The verbs of ``furuta hw`` that call a running bridge."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import click
from rclpy.node import Node

from furuta_bringup.options import namespace_option
from furuta_graph.system_client import TRANSITIONS, BridgeClient
from furuta_ros.context import ros_context
from furuta_ros.spinning import executor_of


@contextmanager
def _bridge_client(namespace: str) -> Iterator[BridgeClient]:
    with ros_context(namespace=namespace):
        node = Node("furuta_hw")
        yield BridgeClient(node, executor_of([node]))


@click.command()
@namespace_option
def arm(namespace: str) -> None:
    """Arm the bridge: commands drive the rig from now on.

    If the bridge refuses, or stops within half a second, the reason is printed and the exit status
    is 1.
    """
    with _bridge_client(namespace) as client:
        client.arm_and_watch()
        print("armed")


@click.command()
@namespace_option
def disarm(namespace: str) -> None:
    """Disarm the bridge: the rig goes to 0 V."""
    with _bridge_client(namespace) as client:
        client.disarm()
        print("disarmed, 0 V")


@click.command()
@click.argument("transition", required=False, type=click.Choice(list(TRANSITIONS)))
@namespace_option
def state(transition: str | None, namespace: str) -> None:
    """Print the state of the managed bridge, after a TRANSITION if given."""
    with _bridge_client(namespace) as client:
        if transition:
            client.change_state(transition)
        print(client.state())
