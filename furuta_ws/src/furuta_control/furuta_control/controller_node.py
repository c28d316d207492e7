"""Node ``controller``: joint_states and friction_estimate → command."""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String

from furuta_control.control import (
    MEMORY,
    MODES_IN_FORCE,
    ControllerParameters,
    control,
    design_controller,
    forget_integrals,
    mode_in_force,
    start_anew,
)
from furuta_control.modes import swing_up
from furuta_model.block import block
from furuta_model.compiled import compiled
from furuta_model.state import SIGNALS
from furuta_model.time_stamps import NANOSECONDS, stamp_nanoseconds, starts_anew
from furuta_ros.messages import read_float, read_joints
from furuta_ros.node import WARNING_PERIOD, FurutaNode
from furuta_ros.spinning import run_node
from furuta_ros.throttled_publisher import ThrottledPublisher
from furuta_ros.topics import (
    ARMED,
    COMMAND,
    FRICTION_ESTIMATE,
    JOINT_STATES,
    LATCHED,
    MODE_IN_FORCE,
    QOS,
)

# Largest number of estimates in transit: the depth of the topic's queue.
MAX_IN_TRANSIT = QOS.depth


class ControllerNode(FurutaNode[ControllerParameters]):
    """Stabilises the pendulum.

    Subscribes to ``joint_states`` and ``friction_estimate``, publishes ``command``: one command
    per state, as soon as both the state and its friction estimate have arrived, in either order.

    Estimates carry no stamp, so they are matched to states by counting. If a state arrives before
    the estimate for the previous one, that estimate is late. The new state is then answered at
    once with the newest estimate, or with F̂ = 0 V if that is older than ``friction_timeout``. The
    late estimate is not matched to a later state when it arrives. If as many estimates in a row are
    late as the queue can hold, they count as lost and are no longer expected.

    A state may be repeated (same stamp) because its estimate seems lost. If the estimate was only
    late, the estimates for the repetitions are surplus: each has the same command published again,
    which tells the plant that it is no longer in transit. If a state that has been answered is
    repeated, its command is published again without a new step.

    A state that has become too old is not answered.

    While ``armed`` says that a rig does not apply the commands, nothing is integrated.

    Publishes ``mode_in_force``, what the controller does: ``off`` until the first state, then
    whenever it changes. A late subscriber gets the last messages.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        self._memory = np.zeros(MEMORY)
        self._x = np.zeros(SIGNALS)
        self._stamp = -1
        self._friction = 0.0
        self._friction_stamp = -1
        self._surplus = 0  # number of estimates minus number of states
        self._missed_in_a_row = 0
        self._repetitions = 0  # of this state while it waits: estimates that may be surplus
        self._applied = True  # whether commands are applied
        self._command = Float64()
        self._answered_stamp = -1
        self._is_repeat = False  # whether this state has been answered and is now repeated
        self.missed_estimates = 0
        super().__init__("controller", ControllerParameters, overrides)
        self.watch_parameters(self.parameters_changed)
        self._publisher = self.publish_on(COMMAND)
        self._throttled = ThrottledPublisher(self, COMMAND)
        self._mode_in_force = ""
        self._mode_publisher = self.create_publisher(
            MODE_IN_FORCE.type, MODE_IN_FORCE.name, LATCHED
        )
        self._report_mode(swing_up.OFF)
        self.subscribe_to(JOINT_STATES, self._on_state)
        self.subscribe_to(FRICTION_ESTIMATE, self._on_friction)
        self.create_subscription(ARMED.type, ARMED.name, self._on_armed, LATCHED)

    def parameters_changed(self, parameters: ControllerParameters) -> None:
        """Redesign the controller; its memory is kept."""
        self._design = block(design_controller(parameters))
        _control(self._memory.copy(), self._x, 0.0, self._design)

    def _on_state(self, message: JointState) -> None:
        read_joints(message, self._x, partly=True)
        stamp = stamp_nanoseconds(message)
        if starts_anew(self._stamp, stamp):
            start_anew(self._memory)
        repeated = stamp == self._stamp
        self._stamp = stamp
        self._is_repeat = repeated and stamp == self._answered_stamp
        if repeated and self._surplus < 0:
            self._repetitions += 1
        else:
            self._repetitions = 0
            self._surplus -= 1
        if self._surplus == 0:
            self._answer()
        elif self._surplus < -1:
            self._answer_without_estimate()

    def _on_friction(self, message: Float64) -> None:
        friction = read_float(message)
        if self._stamp < 0:
            return
        if self._repetitions > 0 and self._surplus >= 0:
            self._repetitions -= 1
            self._publish_command()
            return
        self._friction = friction
        self._friction_stamp = self._stamp
        self._surplus = min(self._surplus + 1, 1)
        if self._surplus == 0:
            self._answer()

    def _on_armed(self, message: Bool) -> None:
        self._applied = message.data

    def _answer(self) -> None:
        self._missed_in_a_row = 0
        self._publish(self._friction)

    def _answer_without_estimate(self) -> None:
        self.missed_estimates += 1
        self._missed_in_a_row += 1
        if self._missed_in_a_row >= MAX_IN_TRANSIT:
            self._surplus = -1
        self.get_logger().warning(
            f"no friction estimate in time ({self.missed_estimates} so far)",
            throttle_duration_sec=WARNING_PERIOD,
        )
        age = self._stamp - self._friction_stamp
        fresh = self._friction_stamp >= 0 and age <= self._timeout
        self._publish(self._friction if fresh else 0.0)

    @property
    def _timeout(self) -> float:
        return self.parameters.friction_timeout * NANOSECONDS

    def _publish(self, friction: float) -> None:
        if not self._is_repeat:
            if not self._applied:
                forget_integrals(self._memory)
            self._command.data, mode = _control(self._memory, self._x, friction, self._design)
            self._answered_stamp = self._stamp
            self._report_mode(mode)
        self._publish_command()

    def _publish_command(self) -> None:
        if not self.message_age.answerable():
            return
        self._publisher.publish(self._command)
        self._throttled.publish(self._command, self._stamp)

    def _report_mode(self, mode: int) -> None:
        """Publish what the controller does, if it is something else than before."""
        name = MODES_IN_FORCE[mode]
        if name != self._mode_in_force:
            self._mode_in_force = name
            self._mode_publisher.publish(String(data=name))


@compiled
def _control(
    memory: np.ndarray, x: np.ndarray, friction: float, design: np.ndarray
) -> tuple[float, int]:
    """Command u [V], and the index of the mode in force."""
    u = control(memory, x, friction, design[0])
    return u, mode_in_force(memory, design[0])


def main() -> None:
    """Entry point of the executable ``controller``."""
    sys.exit(run_node(ControllerNode))
