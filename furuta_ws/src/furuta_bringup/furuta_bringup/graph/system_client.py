"""Clients of the controlled system: resets the plant, arms and disarms the bridge."""

from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future
from std_srvs.srv import SetBool, Trigger

from furuta.settings.nodes import HARDWARE_BRIDGE, PLANT
from furuta_bringup.graph.services import ATTEMPTS, ServiceCaller, ServiceError
from furuta_ros.node import beside
from furuta_ros.topics import DIAGNOSTICS, TRANSITIONS

# Longest wait for the bridge [s].
TIMEOUT = 10.0
# Time after arming within which a stop is reported [s]: that of the bridge's diagnostics and more.
STARTING = 1.2


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


def put_plant(services: ServiceCaller, phi: float, theta: float) -> None:
    """Let the pendulum begin anew at rest with these angles [rad].

    Raises:
        ServiceError: No plant answers, or it rejects the angles.
    """
    state = [Parameter(name, value=value) for name, value in (("phi", phi), ("theta", theta))]
    request = SetParametersAtomically.Request(
        parameters=[each.to_parameter_msg() for each in state]
    )
    result = services.call(PLANT, "set_state", SetParametersAtomically, request).result
    if not result.successful:
        raise ServiceError(f"{PLANT} rejects the state: {result.reason}")


class BridgeClient:
    """Calls the services of the bridge. Raises :class:`ServiceError` if it does not answer."""

    def __init__(self, node: Node, executor: Any) -> None:
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
        """Arm the bridge; raises :class:`ServiceError` also if it stops within a second."""
        self.arm()
        bridge, stopped = beside(self._node, HARDWARE_BRIDGE), Future()

        def receive(message: DiagnosticArray) -> None:
            for status in message.status:
                ours = status.name == bridge
                if ours and status.level == DiagnosticStatus.ERROR and not stopped.done():
                    stopped.set_result(status.message)

        self._node.create_subscription(DIAGNOSTICS.message, DIAGNOSTICS.name, receive, 10)
        self._executor.spin_until_future_complete(stopped, timeout_sec=STARTING)
        if stopped.done():
            raise ServiceError(f"armed, and stopped at once: {stopped.result()}")

    def disarm(self) -> None:
        """Disarm the bridge: the rig goes to 0 V."""
        self._call("arm", SetBool, SetBool.Request(data=False))

    def state(self) -> str:
        """The state of the managed bridge."""
        return str(self._call("get_state", GetState, GetState.Request()).current_state.label)

    def change_state(self, transition: str) -> None:
        """Make one of :data:`TRANSITIONS`; nothing to do if the bridge is already there."""
        number = getattr(Transition, f"TRANSITION_{transition.upper()}")
        goal = TRANSITIONS[transition]
        if self.state() == goal:
            return
        request = ChangeState.Request(transition=Transition(id=number))
        if self._call("change_state", ChangeState, request).success:
            return
        now = self.state()
        if now != goal:
            raise ServiceError(f"{HARDWARE_BRIDGE} did not {transition}, it is {now}; see its log")

    def _call(self, service: str, kind: Any, request: Any, attempts: int = ATTEMPTS) -> Any:
        return self._services.call(HARDWARE_BRIDGE, service, kind, request, TIMEOUT, attempts)
