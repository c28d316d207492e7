"""Node ``controller``: joint_states and friction_estimate → command."""

import sys
from collections.abc import Sequence
from math import pi

import numpy as np
from rcl_interfaces.srv import GetParameters
from rclpy.parameter import Parameter
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, String

from furuta_control.control import (
    ACTIVE_MODES,
    ControllerMemory,
    ControllerParameters,
    active_mode,
    control,
    design_controller,
    forget_integrals,
    reset,
)
from furuta_control.estimate_matching import Answer, EstimateMatching
from furuta_control.estimation import covers_circle
from furuta_control.modes import swing_up
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled, for_types_of
from furuta_model.vibration import is_sustained
from furuta_ros.discovery import clock_advice
from furuta_ros.messages import read_joints, read_value
from furuta_ros.reduction_status import ReductionStatus, vibration_reason
from furuta_ros.sample_node import SampleNode
from furuta_ros.spinning import run_node
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import (
    ACTIVE_MODE,
    ARMED,
    COMMAND,
    FRICTION_ESTIMATE,
    JOINT_STATES,
    LATCHED,
    QOS,
)
from furuta_ros.wire import ANEW, REPEATED, new_float64, take_joint_state

# Time between two warnings that estimates are late [s], the first one at once.
SUMMARY_PERIOD = 30.0
# Parameters of the estimator: which pendulum angles it sees.
SEEN = ["method", "sensors.potentiometer_range", "sensors.ideal"]


class ControllerNode(SampleNode[ControllerParameters]):
    """Stabilises the pendulum.

    Subscribes to ``joint_states`` and ``friction_estimate``, publishes ``command``: one command
    per state, as soon as both the state and its friction estimate have arrived, in either order.

    :class:`EstimateMatching` tells which estimate belongs to which state. A state whose estimate is
    late is answered with the newest one, or with F̂ = 0 V if that is older than
    ``friction_timeout``, and again when the estimate arrives before the next state. A state is
    stepped once; if it is repeated (same stamp), its command is published again.

    A state that has become too old is not answered.

    While ``armed`` says that a rig does not apply the commands, nothing is integrated.

    Publishes ``active_mode``, what the controller does: ``off`` until the first state, then
    whenever it changes. A late subscriber gets the last messages.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        self._memory = new_memory(ControllerMemory)
        self._memory_before = self._memory.copy()  # a step without its estimate
        self._matching = EstimateMatching(QOS.depth)
        self._friction_stamp = -1  # of the state when the newest estimate arrived
        self._applied = True  # whether commands are applied
        self._mode = ""
        super().__init__("controller", ControllerParameters, new_float64(), overrides)
        self._estimator = self.create_client(GetParameters, "estimator/get_parameters")
        self.watch_parameters(self.parameters_changed)
        self._active_mode = swing_up.OFF
        self._mode_publisher = self.create_publisher(ACTIVE_MODE.type, ACTIVE_MODE.name, LATCHED)
        self._publish_mode()
        self._reduction = ReductionStatus(self, self._reason)
        self.take_samples(JOINT_STATES, COMMAND)
        self.subscribe_to(FRICTION_ESTIMATE, self._on_friction, raw=True)
        self.create_subscription(ARMED.type, ARMED.name, self._on_armed, LATCHED)

    def parameters_changed(self, parameters: ControllerParameters) -> None:
        """Redesign the controller; its memory is kept."""
        self._design = block(design_controller(parameters))
        self.compute_with(_take, self._memory)
        self._control = for_types_of(
            _control, self._memory, self.received, 0.0, self._design, self.answer
        )
        begins = parameters.mode == swing_up.MODE.name != self._mode
        if begins and self._estimator.service_is_ready():
            asked = self._estimator.call_async(GetParameters.Request(names=SEEN))
            asked.add_done_callback(self._check_estimator)
        self._mode = parameters.mode

    def _check_estimator(self, answer: Future) -> None:
        """Warn if the estimator does not follow the pendulum where it swings up."""
        given = answer.result().values
        if len(given) < len(SEEN):  # an estimator of one's own
            return
        method, sensor, ideal = given
        if not covers_circle(method.string_value):
            remedy = f"estimator.method is {method.string_value}; set it to whole_circle"
        elif not ideal.bool_value and sensor.double_value < pi:
            remedy = f"the pendulum sensor ends at {sensor.double_value:g} rad; use one of a turn"
        else:
            return
        self.get_logger().warning(f"mode swing_up has no effect: {remedy}")

    @property
    def missed_estimates(self) -> int:
        """Number of states that were answered without their estimates."""
        return self._matching.missed

    def read(self, message: JointState, x: np.ndarray) -> None:
        """Read the state."""
        read_joints(message, x)

    def taken(self, sample: int) -> None:
        """Answer the state if its friction estimate is there, or if it is late."""
        sent = self.message_age.sent
        if sample == REPEATED:
            self._do(self._matching.repetition(sent))
        else:
            self._do(self._matching.state(sent, sample == ANEW))

    def _on_friction(self, data: bytes) -> None:
        answer = self._matching.estimate(read_value(data), self.message_age.sent)
        if self._matching.refused_in_a_row == 0:
            self._friction_stamp = self.stamp
        elif self._matching.suspicious:
            self.warn(
                "early estimates",
                "ignored friction estimates that were sent before the state they should answer"
                f"{clock_advice()}",
            )
        self._do(answer)

    def _on_armed(self, message: Bool) -> None:
        self._applied = message.data

    def _do(self, answer: Answer) -> None:
        if answer is Answer.STEP:
            self._compute(self._matching.friction)
        elif answer is Answer.STEP_WITHOUT:
            self._memory_before[:] = self._memory
            self._compute_without_estimate()
        elif answer is Answer.CORRECT:
            self._memory[:] = self._memory_before
            self._compute(self._matching.friction)
        elif answer is Answer.AGAIN:
            self.publish_answer()

    def _compute_without_estimate(self) -> None:
        self.warn(
            "late estimates",
            f"no friction estimate in time ({self.missed_estimates} so far)",
            SUMMARY_PERIOD,
        )
        age = self.stamp - self._friction_stamp
        timeout = self.parameters.friction_timeout * NANOSECONDS
        fresh = self._friction_stamp >= 0 and age <= timeout
        self._compute(self._matching.friction if fresh else 0.0)

    def _compute(self, friction: float) -> None:
        if not self._applied:
            forget_integrals(self._memory[0])
        mode, reduced = self._control(
            self._memory, self.received, friction, self._design, self.answer
        )
        if mode != self._active_mode:
            self._active_mode = mode
            self._publish_mode()
        self.publish_answer()
        if reduced:
            self._reduction.report()

    def _reason(self) -> str:
        part = float(self._memory["balance"]["super_twisting"]["vibration"]["part"][0])
        return vibration_reason("super-twisting", part)

    def _publish_mode(self) -> None:
        """Publish what the controller does."""
        self._mode_publisher.publish(String(data=ACTIVE_MODES[self._active_mode]))


@compiled
def _take(
    data: bytes, previous: int, x: np.ndarray, answer: np.ndarray, memory: np.ndarray
) -> tuple[int, int, int]:
    """Read a state; :func:`_control` computes with it."""
    sample, stamp = take_joint_state(data, previous, True, x)
    if sample == ANEW:
        reset(memory[0])
    return sample, stamp, 0


@compiled
def _control(
    memory: np.ndarray, x: np.ndarray, friction: float, design: np.ndarray, answer: np.ndarray
) -> tuple[int, bool]:
    """Write the command u [V]; return the index of the active mode, and whether u vibrates."""
    vibration = memory[0].balance.super_twisting.vibration
    swings = vibration.swings
    answer[0].value = control(memory[0], x, friction, design[0])
    reduced = vibration.swings > swings and is_sustained(vibration)
    return active_mode(memory[0], design[0]), reduced


def main() -> None:
    """Entry point of the executable ``controller``."""
    sys.exit(run_node(ControllerNode))
