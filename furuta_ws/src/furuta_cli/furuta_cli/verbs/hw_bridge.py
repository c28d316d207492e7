"""The verbs of ``furuta hw`` that call a running bridge."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import click
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.node import Node
from std_srvs.srv import SetBool

from furuta_cli.options import namespace_option
from furuta_ros.context import ros_context
from furuta_ros.services import ServiceError, call_service
from furuta_ros.spinning import executor_of

BRIDGE = "hardware_bridge"
# Longest wait for the bridge, and for its answer, which can take as long as the rig's [s].
TIMEOUT = 10.0
# Each transition with its number and the state after it.
TRANSITIONS = {
    "configure": (Transition.TRANSITION_CONFIGURE, "inactive"),
    "activate": (Transition.TRANSITION_ACTIVATE, "active"),
    "deactivate": (Transition.TRANSITION_DEACTIVATE, "inactive"),
    "cleanup": (Transition.TRANSITION_CLEANUP, "unconfigured"),
}


class BridgeClient:
    """Calls services of the bridge."""

    def __init__(self) -> None:
        self._node = Node("furuta_hw")
        self._executor = executor_of([self._node])

    def call(self, kind: Any, service: str, request: Any) -> Any:
        """The response to a request, which may be sent more than once."""
        client = self._node.create_client(kind, f"{BRIDGE}/{service}")
        send = partial(client.call_async, request)
        return call_service(self._executor, BRIDGE, client.wait_for_service, send, TIMEOUT)


@contextmanager
def _bridge_client(namespace: str) -> Iterator[BridgeClient]:
    with ros_context(namespace=namespace):
        yield BridgeClient()


@click.command()
@namespace_option
def arm(namespace: str) -> None:
    """Arm the bridge: from now on, commands drive the rig."""
    with _bridge_client(namespace) as client:
        answer = client.call(SetBool, "arm", SetBool.Request(data=True))
    if not answer.success:
        raise ServiceError(f"not armed: {answer.message}")


@click.command()
@namespace_option
def disarm(namespace: str) -> None:
    """Disarm the bridge: the rig goes to 0 V."""
    with _bridge_client(namespace) as client:
        client.call(SetBool, "arm", SetBool.Request(data=False))


@click.command()
@click.argument("transition", required=False, type=click.Choice(list(TRANSITIONS)))
@namespace_option
def state(transition: str | None, namespace: str) -> None:
    """Print the lifecycle state of the bridge, after a TRANSITION if one is given."""
    with _bridge_client(namespace) as client:
        if transition:
            number, goal = TRANSITIONS[transition]
            request = ChangeState.Request(transition=Transition(id=number))
            done = client.call(ChangeState, "change_state", request).success
        now = client.call(GetState, "get_state", GetState.Request()).current_state.label
    if transition and not done and now != goal:
        raise ServiceError(f"{BRIDGE} did not {transition}; it is {now}. See its log")
    print(now)
