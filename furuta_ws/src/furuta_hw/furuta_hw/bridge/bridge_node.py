"""Node ``hardware_bridge``: passes commands to a rig and its measurements to the graph."""

import sys
from collections.abc import Callable, Sequence
from functools import wraps
from math import isfinite, nan, pi
from pathlib import Path
from typing import TypeAlias

from diagnostic_msgs.msg import DiagnosticStatus
from lifecycle_msgs.srv import ChangeState
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.timer import Timer
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

from furuta_hw.bridge.guarded_rig import GuardedRig, SampleClock
from furuta_hw.bridge.parameters import BridgeParameters
from furuta_hw.connection.rig_connection import RigConnection
from furuta_hw.connection.rig_driver import RigSample
from furuta_hw.drivers import make_driver
from furuta_hw.errors import RigError
from furuta_hw.guard import Guard
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import load_rig
from furuta_model.parameters import ParameterError, shortened
from furuta_ros.messages import RefusedError, value_of
from furuta_ros.middleware import describe_discovery, reaches_network
from furuta_ros.node import LATCHED, QOS, FurutaNode, sender
from furuta_ros.simulated_clock import reject_simulated_time
from furuta_ros.spinning import run_node
from furuta_ros.topics import (
    ARMED,
    COMMAND,
    FRICTION_ESTIMATE,
    JOINT_STATES,
    MEASUREMENT,
    Topic,
)
from furuta_ros.wire import joint_state_bytes

CHECK_PERIOD = 0.005  # [s] between two checks of the age of commands and measurements
PUBLISHERS_PERIOD = 0.1  # [s] between two checks for second publishers
LOOP = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND)
START_DELAY = 0.001  # [s] of spinning after which autostart takes effect

Transition: TypeAlias = Callable[[LifecycleState], TransitionCallbackReturn]
ChangeService: TypeAlias = Callable[
    [ChangeState.Request, ChangeState.Response], ChangeState.Response
]
SUCCESS = TransitionCallbackReturn.SUCCESS
FAILURE = TransitionCallbackReturn.FAILURE


class HardwareBridgeNode(LifecycleNodeMixin, FurutaNode[BridgeParameters]):
    """Replaces the plant: publishes ``measurement``, subscribes to ``command`` [V].

    A managed node. When configured it reads the rig and publishes. It drives the rig only while it
    is active and armed by the service ``~/arm``. The reason of a stop is logged once and stays in
    the status on ``/diagnostics``. After a stop the bridge must be armed again. ``armed`` tells the
    controller whether its commands are applied.
    """

    runs_compiled_code = False
    one_per_graph = True

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        FurutaNode.__init__(self, "hardware_bridge", BridgeParameters, overrides)
        others = set(self.services)
        LifecycleNodeMixin.__init__(self)
        of_states = set(self.services) - others
        for service in of_states:
            if service.srv_type is ChangeState:
                service.callback = self._if_possible(service.callback)
        self.guard_services(of_states)
        self._callbacks = {id_: self._logged(call) for id_, call in self._callbacks.items()}
        reject_simulated_time(self, "a rig runs in real time")
        self.rig = Rig()
        self.guard = Guard(self.rig.limits, self.rig.line.sample_time)
        self.guarded_rig: GuardedRig | None = None  # None while unconfigured
        self.failure = ""  # why the last transition failed
        self.samples = 0
        self._receive_scheduled = False
        self._timers_when_configured: list[Timer] = []
        self._send = sender(self.create_publisher(MEASUREMENT.message, MEASUREMENT.name, QOS))
        self._armed = Bool()
        self._armed_publisher = self.create_publisher(ARMED.message, ARMED.name, LATCHED)
        self._armed_publisher.publish(self._armed)
        self.subscribe_to(COMMAND, self._on_command)
        self.subscribe_to(FRICTION_ESTIMATE, self._on_estimate)
        self.create_service(SetBool, "~/arm", self._on_arm)
        # Transitions call methods that a subclass may override, so not from the constructor.
        self._start_timer: Timer | None = self.steady_timer(START_DELAY, self.start_up)

    @property
    def state(self) -> str:
        """The state of the managed node."""
        return str(self._state_machine.current_state[1])

    @property
    def connection(self) -> RigConnection | None:
        """The connection to the rig, None while unconfigured."""
        return self.guarded_rig.connection if self.guarded_rig else None

    def start_up(self) -> str:
        """Enter the state of ``autostart``, once; returns why that failed, if so.

        Called at the latest when the node starts to spin.
        """
        goal = self.parameters.autostart
        if self._start_timer is not None:
            self.destroy_timer(self._start_timer)
            self._start_timer = None
            if goal != "unconfigured" and self.trigger_configure() == SUCCESS and goal == "active":
                self.trigger_activate()
        return "" if self.state == goal else f"{self.state} instead of {goal}: {self.failure}"

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Open the line; the rig sends samples from now on."""
        parameters = self.parameters
        try:
            self.rig = load_rig(Path(parameters.rig)) if parameters.rig else Rig()
            connection = RigConnection(make_driver(parameters.port, self.rig), self._data_arrived)
            connection.open()
        except (RigError, ParameterError) as error:
            return self._fail(str(error))
        limits = self.rig.limits
        if parameters.any_pendulum_angle:
            limits = limits._replace(pendulum_angle=pi)
        stops = self.guard.stops
        self.guard = Guard(limits, self.rig.line.sample_time)
        self.guard.stops = stops  # those since the start of the node
        self.guarded_rig = GuardedRig(connection, self.guard, self._report_end)
        self._timers_when_configured = [
            self.steady_timer(CHECK_PERIOD, self._check),
            self.steady_timer(PUBLISHERS_PERIOD, lambda: self._stop_on_second_publisher(LOOP)),
        ]
        return SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Make arming possible."""
        if self.parameters.read_only:
            return self._fail("read_only: this bridge never drives")
        return SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Set the rig to 0 V and only read it."""
        if self.guarded_rig is not None:
            self.guarded_rig.disarm("deactivated")
        return SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Set the rig to 0 V and close the line."""
        self._close()
        return SUCCESS

    on_shutdown = on_cleanup
    on_error = on_cleanup

    def destroy_node(self) -> None:
        """Set the rig to 0 V and close the line before the node ends."""
        self._close()
        super().destroy_node()
        # rclpy leaves the services of the transitions, and with them the node, in the graph.
        self._state_machine.destroy_when_not_in_use()

    def arm(self) -> str:
        """Arm the rig; returns the reason if that is not possible, otherwise an empty string."""
        if self.state != "active" or self.guarded_rig is None:
            return f"the bridge is {self.state}, must be active"
        if reaches_network() and not self.parameters.network_commands:
            return (
                f"other machines can send commands: discovery is {describe_discovery()}; set "
                "the parameter network_commands to allow it"
            )
        reason = self.second_publishers(LOOP) or self.guarded_rig.arm()
        if not reason:
            self._report_armed()
            self.get_logger().info("armed")
        return reason

    def _close(self) -> None:
        for timer in self._timers_when_configured:
            self.destroy_timer(timer)
        self._timers_when_configured = []
        if self.guarded_rig is not None:
            self.guarded_rig.close()
            self.guarded_rig = None

    def _logged(self, transition: Transition) -> Transition:
        """The callback of a transition; rclpy drops an exception in it without a word."""

        @wraps(transition)
        def call(state: LifecycleState) -> TransitionCallbackReturn:
            try:
                return transition(state)
            except Exception as error:
                self.failure = self.report_failure(transition.__name__, error)
                return TransitionCallbackReturn.ERROR

        return call

    def _if_possible(self, change: ChangeService) -> ChangeService:
        """The service that changes the state; rclpy raises an exception if that is impossible."""

        @wraps(change)
        def call(
            request: ChangeState.Request, response: ChangeState.Response
        ) -> ChangeState.Response:
            wanted = request.transition.label or request.transition.id
            possible = {each[:2] for each in self._state_machine.available_transitions}
            if any(wanted in each for each in possible):
                return change(request, response)
            labels = ", ".join(sorted(label for _, label in possible)) or "none"
            self.get_logger().warning(
                f"no transition {shortened(wanted)} while {self.state}; possible: {labels}"
            )
            response.success = False
            return response

        return call

    def _fail(self, reason: str) -> TransitionCallbackReturn:
        self.failure = reason
        self.get_logger().error(reason)
        return FAILURE

    def _data_arrived(self) -> None:
        """Called by the reading thread: let this node's own thread decode the data."""
        if not self._receive_scheduled:
            self._receive_scheduled = self.run_soon(self._receive)

    def _receive(self) -> None:
        """Publish the samples that have arrived."""
        self._receive_scheduled = False
        guarded = self.guarded_rig
        if guarded is None:
            return  # closed while this call was pending
        was_connected = guarded.connection.connected
        for sample in guarded.samples():
            self._publish(sample, guarded.clock)
        if guarded.connection.connected and not was_connected:
            self.get_logger().info("the line is open again")

    def _publish(self, sample: RigSample, clock: SampleClock) -> None:
        self.samples += 1
        now = self.get_clock().now().nanoseconds
        stamp = clock.stamp(sample.number, now)
        readings = sample.arm_angle, sample.arm_speed, sample.pendulum_angle, nan, sample.voltage
        self._send(joint_state_bytes(stamp, readings))

    def _on_command(self, data: bytes) -> None:
        command = value_of(data)
        self._stop_on_second_publisher((COMMAND,))
        if self.guarded_rig is not None:
            self.guarded_rig.command(command)
        if not isfinite(command):
            raise RefusedError(f"data is {command}, must be finite")

    def _on_estimate(self, data: bytes) -> None:
        """Tell the guard that the friction observer is alive; the controller uses the estimate."""
        self.guard.estimated()

    def _on_arm(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if request.data:
            response.message = self.arm()
            response.success = not response.message
        else:
            if self.guarded_rig is not None:
                self.guarded_rig.disarm("disarmed by request")
            response.success, response.message = True, "disarmed"
        return response

    def _check(self) -> None:
        self._receive()
        if self.guarded_rig is not None:
            self.guarded_rig.check()

    def _stop_on_second_publisher(self, topics: Sequence[Topic]) -> None:
        """Stop the rig if somebody else publishes one of the topics too."""
        several = self.second_publishers(topics) if self.guard.armed else ""
        if several and self.guarded_rig is not None:
            self.guarded_rig.stop(several)

    def summary(self) -> str:
        """Samples of the rig, and how often it was stopped."""
        return f"{self.samples} samples, {self.guard.stops} stops"

    def _report_armed(self) -> None:
        """Publish whether the rig applies commands, if that has changed."""
        if self.guard.armed != self._armed.data:
            self._armed.data = self.guard.armed
            self._armed_publisher.publish(self._armed)

    def _report_end(self) -> None:
        """Report that the rig is not driven any more, because of a problem or as was wished."""
        self._report_armed()
        reason = self.guard.reason
        if self.guard.is_stopped:
            self.get_logger().error(f"stopped, 0 V: {reason}")
        else:
            self.get_logger().info(f"not armed any more, 0 V: {reason}")
        self.publish_status()

    def status(self) -> DiagnosticStatus:
        """OK while it drives, WARN while it only reads, ERROR after a stop or without a line."""
        guard, connection = self.guard, self.connection
        if guard.armed:
            level, text = DiagnosticStatus.OK, "driving"
        elif connection is not None and connection.connected:
            level = DiagnosticStatus.ERROR if guard.is_stopped else DiagnosticStatus.WARN
            text = guard.reason
        else:
            reason = connection.failure if connection else self.failure
            level, text = DiagnosticStatus.ERROR, reason or "no line"
        return DiagnosticStatus(level=level, message=text, hardware_id=self.parameters.port)

    def statistics(self) -> dict[str, object]:
        """What is armed, counts of the rig and of its line."""
        guard, connection = self.guard, self.connection
        values = {"state": self.state, "armed": guard.armed, "stops": guard.stops}
        values |= {"samples": self.samples} | super().statistics()
        if connection is not None:
            line = connection.statistics()
            values |= {
                "frames lost": line.lost,
                "frames corrupt": line.corrupt,
                "frames repeated": line.repeated,
                "frames of other sessions": line.other_sessions,
                "frames the rig discarded": line.discarded_by_rig,
                "samples skipped": connection.skipped_samples,
            }
        return values


def main() -> None:
    """Entry point of the executable ``hardware_bridge``."""
    sys.exit(run_node(HardwareBridgeNode))
