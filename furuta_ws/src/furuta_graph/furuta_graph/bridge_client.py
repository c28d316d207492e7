"""Client of a running bridge: arms and disarms it, and changes its lifecycle state."""

from __future__ import annotations

from functools import partial
from typing import Any

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.node import Node
from std_srvs.srv import SetBool

from furuta_graph.description import HARDWARE_BRIDGE
from furuta_ros.services import ATTEMPTS, ServiceError, call_service
from furuta_ros.spinning import executor_of

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
    """Calls the services of the bridge. Raises :class:`ServiceError` if it does not answer."""

    def __init__(self) -> None:
        self._node = Node("furuta_hw")
        self._executor = executor_of([self._node])

    def arm(self) -> None:
        """Arm the bridge. Raises :class:`ServiceError` with the reason if it refuses.

        The request is sent once, because a copy that arrives late would arm again after a stop.
        A harmless request goes first: after its response both sides know each other.
        """
        self.state()
        answer = self._call(SetBool, "arm", SetBool.Request(data=True), attempts=1)
        if not answer.success:
            raise ServiceError(f"not armed: {answer.message}")

    def disarm(self) -> None:
        """Disarm the bridge: the rig goes to 0 V."""
        self._call(SetBool, "arm", SetBool.Request(data=False))

    def state(self) -> str:
        """The state of the managed bridge."""
        label = self._call(GetState, "get_state", GetState.Request()).current_state.label
        return str(label)

    def change_state(self, transition: str) -> None:
        """Make one of :data:`TRANSITIONS`; nothing to do if the bridge is already there."""
        number, goal = TRANSITIONS[transition]
        request = ChangeState.Request(transition=Transition(id=number))
        if self._call(ChangeState, "change_state", request).success:
            return
        now = self.state()
        if now != goal:
            raise ServiceError(f"{HARDWARE_BRIDGE} did not {transition}, it is {now}; see its log")

    def _call(self, kind: Any, service: str, request: Any, attempts: int = ATTEMPTS) -> Any:
        """The response to a request, which is sent up to ``attempts`` times."""
        client = self._node.create_client(kind, f"{HARDWARE_BRIDGE}/{service}")
        send = partial(client.call_async, request)
        wait = client.wait_for_service
        return call_service(self._executor, HARDWARE_BRIDGE, wait, send, TIMEOUT, attempts)
