"""Node ``hardware_bridge``: command → rig → measurement, in the place of the plant."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from time import monotonic

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.clock import Clock, ClockType
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.timer import Timer
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

from furuta_hw.connection import Connection
from furuta_hw.diagnostics_node import diagnostics
from furuta_hw.errors import LineError
from furuta_hw.frames import ARMED, Sensors
from furuta_hw.parameters import BridgeParameters
from furuta_hw.rig import Rig
from furuta_hw.rig_file import load_rig
from furuta_hw.safety import Guard
from furuta_hw.sensing import Timeline
from furuta_model.parameters import ParameterError
from furuta_model.state import EFFORT
from furuta_ros.messages import NANOSECONDS, JointWriter, RefusedError
from furuta_ros.node import FurutaNode
from furuta_ros.spinning import run_node
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, MEASUREMENT

WATCH = 0.005  # [s] between looks at the age of commands and measurements
DIAGNOSE = 1.0  # [s] between diagnostics when nothing happens
RECONNECT = 1.0  # [s] between attempts to open a line that broke, or to wake a silent rig

SUCCESS = TransitionCallbackReturn.SUCCESS
FAILURE = TransitionCallbackReturn.FAILURE


class HardwareBridgeNode(LifecycleNodeMixin, FurutaNode[BridgeParameters]):
    """Takes the plant's place: publishes ``measurement``, subscribes to ``command`` [V].

    A managed node. Configured, it reads the rig and publishes; only active, and armed by the
    service ``~/arm``, it drives. What stops it is said once in the log and kept in
    ``/diagnostics``; it drives again when it is armed again.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        FurutaNode.__init__(self, "hardware_bridge", BridgeParameters, overrides)
        LifecycleNodeMixin.__init__(self)
        self.rig = Rig()
        self.guard = Guard(self.rig.limits, self.rig.line.sample_time)
        self.connection: Connection | None = None
        self.trouble = ""  # why the node is not where it should be
        self.samples = 0
        self._handing_over = False
        self._reconnect_at = 0.0
        self._stops = 0
        self._bad = 0
        self._timers_of_state: list[Timer] = []
        self._writer = JointWriter()
        self._publisher = self.publish_on(MEASUREMENT)
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.subscribe_to(COMMAND, self._on_command)
        self.subscribe_to(FRICTION_ESTIMATE, self._on_estimate)
        self.create_service(SetBool, "~/arm", self._on_arm)
        self._autostart()

    @property
    def state(self) -> str:
        """The state of the managed node."""
        return str(self._state_machine.current_state[1])

    def _autostart(self) -> None:
        wanted = self.parameters.autostart
        if wanted != "unconfigured" and self.trigger_configure() == SUCCESS and wanted == "active":
            self.trigger_activate()

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Open the line; the rig streams from now on."""
        parameters = self.parameters
        try:
            self.rig = load_rig(Path(parameters.rig)) if parameters.rig else Rig()
            self.guard = Guard(self.rig.limits, self.rig.line.sample_time)
            self._stops = 0
            self._connect()
        except (LineError, ParameterError) as error:
            return self._fail(str(error))
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._timers_of_state = [
            self.create_timer(WATCH, self._watch, clock=steady),
            self.create_timer(DIAGNOSE, self._diagnose, clock=steady),
        ]
        return SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Make arming possible."""
        if self.parameters.read_only:
            return self._fail("read_only: this bridge never drives")
        return SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """0 V, and reading only."""
        self._stop("deactivated")
        return SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Close the line."""
        self._release()
        return SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """0 V, and close the line."""
        self._release()
        return SUCCESS

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """0 V, and close the line."""
        self._release()
        return SUCCESS

    def destroy_node(self) -> None:
        """0 V before the end."""
        self._release()
        super().destroy_node()

    def _fail(self, reason: str) -> TransitionCallbackReturn:
        self.trouble = reason
        self.get_logger().error(reason)
        return FAILURE

    def _connect(self) -> None:
        self.connection = Connection(self.parameters.port, self.rig, self._arrived)
        self._drive = self.rig.drive.channel
        self._bad = 0
        self._forget()

    def _forget(self) -> None:
        """Begin a new session: nothing of the last one is of use."""
        self._timeline = Timeline(round(self.rig.line.sample_time * NANOSECONDS))
        self.guard.forget()
        self._reconnect_at = monotonic() + RECONNECT

    def _release(self) -> None:
        self._stop("the bridge ends")
        for timer in self._timers_of_state:
            self.destroy_timer(timer)
        self._timers_of_state = []
        if self.connection is not None:
            self.connection.close()
            self.connection = None

    def _arrived(self) -> None:
        """Called by the line's thread: have this node's own thread take what came."""
        executor = self.executor
        if executor is not None and not self._handing_over:
            self._handing_over = True
            executor.create_task(self._take)

    def _take(self) -> None:
        self._handing_over = False
        if self.connection is None:
            return
        try:
            samples = self.connection.take()
        except LineError as error:
            self._break(error)
            return
        for sensors in samples:
            self._measure(self.connection, sensors)

    def _measure(self, connection: Connection, sensors: Sensors) -> None:
        x = connection.sensing.take(sensors)
        bad, self._bad = self._bad, connection.host.bad
        self.guard.line(self._bad - bad)
        self.guard.measured(
            monotonic(), x, connection.sensing.at_rail, sensors.status, connection.sensing.steps
        )
        self._tell()
        if sensors.status & ARMED and not self.guard.armed:
            self._send_stop()
        self.samples += 1
        self._reconnect_at = monotonic() + RECONNECT
        self._writer.stamp(self._timeline.stamp(sensors.sample, self.get_clock().now().nanoseconds))
        self._publisher.publish(self._writer.fill(x, x[EFFORT]))

    def _on_command(self, message: Float64) -> None:
        volts = self.guard.command(monotonic(), message.data)
        self._tell()
        if volts is not None and self.connection is not None:
            try:
                self.connection.host.drive(self._drive.to_code(volts))
            except LineError as error:
                self._break(error)
        if not isfinite(message.data):
            raise RefusedError(f"data is {message.data}, must be finite")

    def _on_estimate(self, message: Float64) -> None:
        """The controller would go on without its observer; a real rig is driven by a whole loop."""
        self.guard.estimated()

    def _on_arm(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if not request.data:
            self._stop("disarmed by request")
            response.success, response.message = True, "disarmed"
            return response
        response.message = self._arm()
        response.success = not response.message
        return response

    def _arm(self) -> str:
        """Arm; returns the reason if that cannot be."""
        if self.state != "active" or self.connection is None:
            return f"the bridge is {self.state}, must be active"
        if self.guard.armed:
            return ""
        reason = self.guard.arm(monotonic())
        if not reason:
            try:
                self.connection.host.arm()
            except LineError as error:
                self._break(error)
                return str(error)
            self.get_logger().info("armed")
        return reason

    def _stop(self, reason: str) -> None:
        self.guard.stop(reason)
        self._tell()
        self._send_stop()

    def _send_stop(self) -> None:
        if self.connection is not None:
            try:
                self.connection.host.stop()
            except LineError:
                return  # the rig's own watchdog sees to it

    def _tell(self) -> None:
        """Say once why the guard has stopped, and have the rig stop with it."""
        if self.guard.stops != self._stops:
            self._stops = self.guard.stops
            self._send_stop()
            self.get_logger().error(f"stopped, 0 V: {self.guard.reason}")
            self._diagnose()

    def _break(self, error: LineError) -> None:
        self.guard.stop(str(error))
        self._tell()
        self.trouble = str(error)
        if self.connection is not None:
            self.connection.close()
            self.connection = None
        self._reconnect_at = monotonic() + RECONNECT

    def _watch(self) -> None:
        if not self._timers_of_state:
            return  # released while this call was under way
        self._take()
        self.guard.check(monotonic())
        self._tell()
        if monotonic() > self._reconnect_at:
            self._reconnect()

    def _reconnect(self) -> None:
        """Open a line that broke, or ask a silent rig anew; whichever, it is armed by hand."""
        try:
            if self.connection is not None:
                self.connection.begin_anew()
                self._forget()
                return
            self._connect()
            self.trouble = ""
            self.get_logger().info("the line is back")
        except LineError as error:
            self.trouble = str(error)
            self._reconnect_at = monotonic() + RECONNECT

    def _diagnose(self) -> None:
        self._diagnostics.publish(diagnostics(self))


def main() -> None:
    """Entry point of the executable ``hardware_bridge``."""
    sys.exit(run_node(HardwareBridgeNode))
