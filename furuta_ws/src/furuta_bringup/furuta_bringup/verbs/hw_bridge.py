"""The verbs of ``furuta hw`` that speak to a running bridge."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import click
import rclpy
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.node import Node
from std_srvs.srv import SetBool

from furuta_bringup.operator import ServiceError
from furuta_ros.spinning import executor_of

BRIDGE = "hardware_bridge"
# Longest wait for the bridge, and for its answer, which may wait for the rig [s].
TIMEOUT = 10.0
TRANSITIONS = {
    "configure": Transition.TRANSITION_CONFIGURE,
    "activate": Transition.TRANSITION_ACTIVATE,
    "deactivate": Transition.TRANSITION_DEACTIVATE,
    "cleanup": Transition.TRANSITION_CLEANUP,
}


@contextmanager
def _node() -> Iterator[Node]:
    rclpy.init(args=[])
    try:
        yield Node("furuta_hw")
    finally:
        rclpy.try_shutdown()


def _call(node: Node, kind: Any, service: str, request: Any) -> Any:
    client = node.create_client(kind, f"{BRIDGE}/{service}")
    if not client.wait_for_service(TIMEOUT):
        raise ServiceError(f"no node {BRIDGE} answers (waited {TIMEOUT:g} s)")
    future = client.call_async(request)
    executor_of([node]).spin_until_future_complete(future, timeout_sec=TIMEOUT)
    if not future.done():
        raise ServiceError(f"{BRIDGE} did not answer within {TIMEOUT:g} s")
    return future.result()


@click.command()
def arm() -> None:
    """Arm the bridge: from now on commands drive the rig."""
    with _node() as node:
        answer = _call(node, SetBool, "arm", SetBool.Request(data=True))
    if not answer.success:
        raise ServiceError(f"not armed: {answer.message}")


@click.command()
def disarm() -> None:
    """Disarm the bridge: 0 V."""
    with _node() as node:
        _call(node, SetBool, "arm", SetBool.Request(data=False))


@click.command()
@click.argument("transition", required=False, type=click.Choice(list(TRANSITIONS)))
def state(transition: str | None) -> None:
    """Print the state of the managed bridge, after a TRANSITION if one is given."""
    with _node() as node:
        if transition:
            request = ChangeState.Request(transition=Transition(id=TRANSITIONS[transition]))
            if not _call(node, ChangeState, "change_state", request).success:
                raise ServiceError(f"{BRIDGE} did not {transition}; its log says why")
        print(_call(node, GetState, "get_state", GetState.Request()).current_state.label)
