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

from furuta_graph.parameter_client import ServiceError
from furuta_ros.spinning import executor_of

BRIDGE = "hardware_bridge"
# Longest wait for the bridge, and for its answer, which may wait for the rig [s].
TIMEOUT = 10.0
ATTEMPTS = 5
# Each with the state that it leads to.
TRANSITIONS = {
    "configure": (Transition.TRANSITION_CONFIGURE, "inactive"),
    "activate": (Transition.TRANSITION_ACTIVATE, "active"),
    "deactivate": (Transition.TRANSITION_DEACTIVATE, "inactive"),
    "cleanup": (Transition.TRANSITION_CLEANUP, "unconfigured"),
}


class Caller:
    """Calls services of the bridge."""

    def __init__(self) -> None:
        self._node = Node("furuta_hw")
        self._executor = executor_of([self._node])

    def call(self, kind: Any, service: str, request: Any) -> Any:
        """Ask until there is an answer: the first one can pass before both sides are known.

        To ask twice comes to the same as once.
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
def _caller() -> Iterator[Caller]:
    rclpy.init(args=[])
    try:
        yield Caller()
    finally:
        rclpy.try_shutdown()


@click.command()
def arm() -> None:
    """Arm the bridge: from now on commands drive the rig."""
    with _caller() as caller:
        answer = caller.call(SetBool, "arm", SetBool.Request(data=True))
    if not answer.success:
        raise ServiceError(f"not armed: {answer.message}")


@click.command()
def disarm() -> None:
    """Disarm the bridge: 0 V."""
    with _caller() as caller:
        caller.call(SetBool, "arm", SetBool.Request(data=False))


@click.command()
@click.argument("transition", required=False, type=click.Choice(list(TRANSITIONS)))
def state(transition: str | None) -> None:
    """Print the state of the managed bridge, after a TRANSITION if one is given."""
    with _caller() as caller:
        if transition:
            number, goal = TRANSITIONS[transition]
            request = ChangeState.Request(transition=Transition(id=number))
            done = caller.call(ChangeState, "change_state", request).success
        now = caller.call(GetState, "get_state", GetState.Request()).current_state.label
    if transition and not done and now != goal:
        raise ServiceError(f"{BRIDGE} did not {transition}, it is {now}; its log says why")
    print(now)
