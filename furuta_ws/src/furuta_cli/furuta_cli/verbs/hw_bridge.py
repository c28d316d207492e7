"""The verbs of ``furuta hw`` that call a running bridge."""

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

from furuta_graph.parameter_client import ServiceError
from furuta_ros.spinning import executor_of

BRIDGE = "hardware_bridge"
# Longest wait for the bridge, and for its answer, which can take as long as the rig's [s].
TIMEOUT = 10.0
ATTEMPTS = 5
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
        """Call a service until it answers: an answer is lost while discovery is not complete.

        Calling these services twice has the same effect as calling them once.
        """
        client = self._node.create_client(kind, f"{BRIDGE}/{service}")
        if not client.wait_for_service(TIMEOUT):
            raise ServiceError(f"no node {BRIDGE} answers (waited {TIMEOUT:g} s)")
        for _ in range(ATTEMPTS):
            future = client.call_async(request)
            self._executor.spin_until_future_complete(future, timeout_sec=TIMEOUT / ATTEMPTS)
            if future.done():
                return future.result()
        raise ServiceError(f"{BRIDGE} did not answer within {TIMEOUT:g} s")


@contextmanager
def _bridge_client() -> Iterator[BridgeClient]:
    rclpy.init(args=[])
    try:
        yield BridgeClient()
    finally:
        rclpy.try_shutdown()


@click.command()
def arm() -> None:
    """Arm the bridge: commands drive the rig from now on."""
    with _bridge_client() as client:
        answer = client.call(SetBool, "arm", SetBool.Request(data=True))
    if not answer.success:
        raise ServiceError(f"not armed: {answer.message}")


@click.command()
def disarm() -> None:
    """Disarm the bridge: the rig goes to 0 V."""
    with _bridge_client() as client:
        client.call(SetBool, "arm", SetBool.Request(data=False))


@click.command()
@click.argument("transition", required=False, type=click.Choice(list(TRANSITIONS)))
def state(transition: str | None) -> None:
    """Print the state of the managed bridge, after a TRANSITION if given."""
    with _bridge_client() as client:
        if transition:
            number, goal = TRANSITIONS[transition]
            request = ChangeState.Request(transition=Transition(id=number))
            done = client.call(ChangeState, "change_state", request).success
        now = client.call(GetState, "get_state", GetState.Request()).current_state.label
    if transition and not done and now != goal:
        raise ServiceError(f"{BRIDGE} did not {transition}, it is {now}; see its log")
    print(now)
