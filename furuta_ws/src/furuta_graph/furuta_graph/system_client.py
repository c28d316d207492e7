"""Clients of the controlled system: resets the plant, arms and disarms the bridge."""

from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, Trigger

from furuta_ros.services import ATTEMPTS, ServiceCaller, ServiceError, WaitsForFutures
from furuta_ros.topics import ARMED, DIAGNOSTICS, LATCHED
from furuta_sim.settings.nodes import HARDWARE_BRIDGE, PLANT

# Longest wait for the bridge [s].
TIMEOUT = 10.0
# Time after arming within which a stop is reported, and longest wait for its reason [s].
STARTING = 0.5
# Each transition with its number and the state after it.
TRANSITIONS = {
    "configure": (Transition.TRANSITION_CONFIGURE, "inactive"),
    "activate": (Transition.TRANSITION_ACTIVATE, "active"),
    "deactivate": (Transition.TRANSITION_DEACTIVATE, "inactive"),
    "cleanup": (Transition.TRANSITION_CLEANUP, "unconfigured"),
}


def reset_plant(services: ServiceCaller) -> str:
    """Put the pendulum into its initial state; returns the plant's answer.

    Estimator and friction observer start anew when its next measurement arrives.

    Raises:
        ServiceError: No plant answers, or it rejects the reset.
    """
    answer = services.call(PLANT, "reset", Trigger, Trigger.Request())
    if not answer.success:
        raise ServiceError(f"{PLANT} rejects the reset: {answer.message}")
    return str(answer.message)


class BridgeClient:
    """Calls the services of the bridge. Raises :class:`ServiceError` if it does not answer."""

    def __init__(self, node: Node, executor: WaitsForFutures) -> None:
        self._node, self._executor = node, executor
        self._services = ServiceCaller(node, executor)

    def arm(self) -> None:
        """Arm the bridge. Raises :class:`ServiceError` with the reason if it refuses.

        The request is sent once, because a copy that arrives late would arm again after a stop.
        A harmless request goes first: after its response both sides know each other.
        """
        self.state()
        answer = self._call("arm", SetBool, SetBool.Request(data=True), attempts=1)
        if not answer.success:
            raise ServiceError(f"not armed: {answer.message}")

    def arm_and_watch(self) -> None:
        """Arm the bridge; raises :class:`ServiceError` also if it stops within half a second."""
        stop = _Stop(self._node)
        self.arm()
        stop.wait(self._executor)

    def disarm(self) -> None:
        """Disarm the bridge: the rig goes to 0 V."""
        self._call("arm", SetBool, SetBool.Request(data=False))

    def state(self) -> str:
        """The state of the managed bridge."""
        return str(self._call("get_state", GetState, GetState.Request()).current_state.label)

    def change_state(self, transition: str) -> None:
        """Make one of :data:`TRANSITIONS`; nothing to do if the bridge is already there."""
        number, goal = TRANSITIONS[transition]
        request = ChangeState.Request(transition=Transition(id=number))
        if self._call("change_state", ChangeState, request).success:
            return
        now = self.state()
        if now != goal:
            raise ServiceError(f"{HARDWARE_BRIDGE} did not {transition}, it is {now}; see its log")

    def _call(self, service: str, kind: Any, request: Any, attempts: int = ATTEMPTS) -> Any:
        return self._services.call(HARDWARE_BRIDGE, service, kind, request, TIMEOUT, attempts)


class _Stop:
    """Waits for a stop soon after arming, and for its reason; the node is used for nothing else."""

    def __init__(self, node: Node) -> None:
        self._was_armed = False
        self._stopped, self._explained = Future(), Future()
        node.create_subscription(ARMED.type, ARMED.name, self._on_armed, LATCHED)
        node.create_subscription(DIAGNOSTICS.type, DIAGNOSTICS.name, self._on_diagnostics, 10)

    def wait(self, executor: WaitsForFutures) -> None:
        """Raises ServiceError if the bridge stops before the time is up."""
        executor.spin_until_future_complete(self._stopped, timeout_sec=STARTING)
        if self._stopped.done():
            executor.spin_until_future_complete(self._explained, timeout_sec=STARTING)
            explained = self._explained.done()
            reason = self._explained.result() if explained else "the bridge's log has the reason"
            raise ServiceError(f"armed, and stopped at once: {reason}")

    def _on_armed(self, message: Bool) -> None:
        if self._was_armed and not message.data and not self._stopped.done():
            self._stopped.set_result(None)
        self._was_armed = self._was_armed or message.data

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        """Take the reason from the bridge's first report of an error after arming."""
        for status in message.status:
            ours = status.name.startswith(HARDWARE_BRIDGE)
            failed = status.level == DiagnosticStatus.ERROR
            if ours and failed and self._was_armed and not self._explained.done():
                self._explained.set_result(status.message)
