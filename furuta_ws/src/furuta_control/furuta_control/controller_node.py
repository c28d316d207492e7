"""Node ``controller``: joint_states and friction_estimate → command."""

import sys
from collections.abc import Sequence
from math import isnan

import numpy as np
from rclpy.parameter import Parameter
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
from furuta_control.modes import mode
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled, for_types_of
from furuta_model.state import LARGEST_VALUE, is_possible
from furuta_ros.messages import RefusedError, read_value, typed_joint_state
from furuta_ros.node import LATCHED, FurutaNode, LoopPublisher
from furuta_ros.spinning import run_node
from furuta_ros.time_stamps import NANOSECONDS, NEVER, starts_anew
from furuta_ros.topics import ACTIVE_MODE, ARMED, COMMAND, FRICTION_ESTIMATE, JOINT_STATES
from furuta_ros.wire import NO_SIGNALS, Signals, unpack_joint_state, value_bytes

# Time between two warnings that estimates are late [s], the first one at once.
SUMMARY_PERIOD = 30.0


class ControllerNode(FurutaNode[ControllerParameters]):
    """Stabilises the pendulum.

    Subscribes to ``joint_states`` and ``friction_estimate``, publishes ``command``: one for each
    state, when its friction estimate comes. Estimates carry no stamp, so a state has an estimate if
    one comes before the next state. Once a state has had none, the next one does not wait: it is
    answered at once with the last estimate, or with F̂ = 0 V if that is older than
    ``friction_timeout``. When estimates come again, states wait for them again. In simulated time
    every state waits.

    A state that is repeated (same stamp) makes no new step: once it has been answered, the last
    command is published again. While ``armed`` says that a rig does not apply the commands, nothing
    is integrated.

    Publishes ``active_mode``, what the controller does: ``off`` until the first state, then
    whenever it changes. A late subscriber gets the last messages.

    Attributes:
        missed_estimates: Number of states that were answered without their estimates.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        super().__init__("controller", ControllerParameters, overrides)
        self._memory = new_memory(ControllerMemory)
        self._x, self._stamp, self._command = NO_SIGNALS, NEVER, 0.0
        self._friction, self._friction_stamp = 0.0, NEVER  # of the state before the estimate
        self._is_estimated = True  # whether an estimate has come since the last state
        self._answered_stamp = NEVER
        self._is_applied = True  # whether a rig applies the commands
        self.missed_estimates = 0
        self._active_mode = mode.OFF
        self.design_by(self._design)
        self._mode_publisher = self.create_publisher(ACTIVE_MODE.message, ACTIVE_MODE.name, LATCHED)
        self._publish_mode()
        self._publisher = LoopPublisher(self, COMMAND)
        self.subscribe_to(JOINT_STATES, self.on_state)
        self.subscribe_to(FRICTION_ESTIMATE, self.on_friction)
        self.create_subscription(ARMED.message, ARMED.name, self._on_armed, LATCHED)

    def statistics(self) -> dict[str, object]:
        """Also the mode, and the states that had no estimate in time."""
        mode_now = ACTIVE_MODES[self._active_mode]
        counts = {"mode": mode_now, "estimates missed": self.missed_estimates}
        return counts | super().statistics()

    def _design(self, parameters: ControllerParameters) -> None:
        """Redesign the controller; its memory is kept."""
        self._controller = block(design_controller(parameters))
        self._step = for_types_of(_step, self._memory, self._x, 0.0, self._controller, 0, True)
        self._sample_time = parameters.sample_time * NANOSECONDS
        self._timeout = parameters.friction_timeout * NANOSECONDS

    def on_state(self, data: bytes) -> None:
        """Wait for the state's estimate, or answer at once if the last state has had none."""
        stamp, self._x = unpack_joint_state(data) or typed_joint_state(data)
        if stamp == self._stamp:
            if stamp == self._answered_stamp:
                self._publish()
            return
        is_anew, self._stamp = starts_anew(stamp - self._stamp), stamp
        if is_anew:
            self._answered_stamp = NEVER
        waits = self._is_estimated or is_anew or self.time_is_simulated()
        self._is_estimated = False
        if not waits:
            self._answer_without_estimate()

    def on_friction(self, data: bytes) -> None:
        """Answer the state with its estimate."""
        self._friction, self._friction_stamp = read_value(data), self._stamp
        self._is_estimated = True
        if self._stamp != self._answered_stamp:
            self._answer(self._friction)

    def _answer_without_estimate(self) -> None:
        self.missed_estimates += 1
        missed = f"no friction estimate in time ({self.missed_estimates} so far)"
        self.warn("late estimates", missed, SUMMARY_PERIOD)
        is_fresh = self._stamp - self._friction_stamp <= self._timeout
        self._answer(self._friction if is_fresh else 0.0)

    def _answer(self, friction: float) -> None:
        """Compute the command for the state and publish it."""
        interval = self._stamp - self._answered_stamp
        samples = 0 if starts_anew(interval) else max(round(interval / self._sample_time), 1)
        command, active = self._step(
            self._memory, self._x, friction, self._controller, samples, self._is_applied
        )
        if isnan(command):
            raise RefusedError(f"no value of x may be larger than {LARGEST_VALUE:g}: {self._x}")
        self._command, self._answered_stamp = command, self._stamp
        if active != self._active_mode:
            self._active_mode = active
            self._publish_mode()
        self._publish()

    def _publish(self) -> None:
        self._publisher.publish(value_bytes(self._command), self._stamp)

    def _publish_mode(self) -> None:
        self._mode_publisher.publish(String(data=ACTIVE_MODES[self._active_mode]))

    def _on_armed(self, message: Bool) -> None:
        self._is_applied = message.data


@compiled
def _step(
    memory: np.ndarray,
    state: Signals,
    friction: float,
    controller: np.ndarray,
    samples: int,
    is_applied: bool,
) -> tuple[float, int]:
    """The command u [V] and what the controller does.

    The state is ``samples`` after the last one, or begins anew if that is 0. The command is NaN,
    without a step, if a number of the state is impossible.
    """
    x = np.array(state)
    if not is_possible(x):
        return np.nan, 0
    if samples == 0:
        reset(memory[0])
    for _ in range(samples - 1):
        control(memory[0], x, friction, controller[0])
    if not is_applied:
        forget_integrals(memory[0])
    u = control(memory[0], x, friction, controller[0])
    return u, active_mode(memory[0], controller[0])


def main() -> None:
    """Entry point of the executable ``controller``."""
    sys.exit(run_node(ControllerNode))
