"""Node ``friction_observer``: joint_states → friction_estimate."""

import sys
from collections.abc import Sequence
from math import isnan

import numpy as np
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

from furuta_friction.compensation import (
    CompensationMemory,
    ObserverParameters,
    allow,
    beyond_adaptation,
    design_compensator,
    estimate_friction,
    reset,
    switched_off,
)
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled
from furuta_model.state import OBSERVED_FRICTION, THETA_DOT
from furuta_ros.messages import read_joints
from furuta_ros.reduction_status import ReductionStatus, vibration_reason
from furuta_ros.sample_node import SampleNode
from furuta_ros.spinning import run_node
from furuta_ros.topics import FRICTION_ESTIMATE, JOINT_STATES
from furuta_ros.wire import ANEW, REPEATED, new_float64, take_joint_state

# Time between two checks of the adapted levels [s].
LEVELS_PERIOD = 5.0
# What there is to say about a sample.
REDUCED, NOT_OBSERVED = 1, 2


class FrictionObserverNode(SampleNode[ObserverParameters]):
    """Estimates the friction in the arm's joint.

    Subscribes to ``joint_states``, publishes ``friction_estimate`` [V], one for each state. If a
    state is repeated (same stamp), the last estimate is published again without a new step.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        self._memory = new_memory(CompensationMemory)
        self._applied: ObserverParameters | None = None
        super().__init__("friction_observer", ObserverParameters, new_float64(), overrides)
        self.watch_parameters(self.parameters_changed)
        self._reduction = ReductionStatus(self, self._reason)
        self.take_samples(JOINT_STATES, FRICTION_ESTIMATE)
        self.steady_timer(LEVELS_PERIOD, self._check_levels)

    def parameters_changed(self, parameters: ObserverParameters) -> None:
        """Switch to the compensator that the parameters describe; the memory is kept.

        After a change a compensation that the guard has switched off is tried again.
        """
        if parameters != self._applied:
            allow(self._memory[0])
        self._applied = parameters
        self.compute_with(_take, self._memory, block(design_compensator(parameters)))

    def read(self, message: JointState, x: np.ndarray) -> None:
        """Read the state."""
        read_joints(message, x)

    def report(self, condition: int, interval: int) -> None:
        """Report that the guard has acted, or that the compensation lacks the observed friction."""
        chosen = self.parameters.chosen
        if condition == REDUCED:
            self._reduction.report()
        elif condition == NOT_OBSERVED and chosen.needs_observed_friction:
            self.warn(
                "no observed friction",
                f"compensation {chosen.name} needs effort (observed friction) in joint_states; "
                "use an estimator that observes it (method kalman)",
            )

    def _reason(self) -> str:
        if switched_off(self._memory):
            return self.parameters.switch_off_reason
        part = float(self._memory["guard"]["vibration"]["part"][0])
        return vibration_reason("the friction compensation", part)

    def _check_levels(self) -> None:
        if beyond_adaptation(self._memory, self.parameters):
            self.get_logger().warning(
                "compensation adaptive: a level is at its limit, a third or three times what "
                "alpha0 and alpha1 say; the friction is not as the parameters describe it"
            )


@compiled
def _take(
    data: bytes,
    previous: int,
    x: np.ndarray,
    answer: np.ndarray,
    memory: np.ndarray,
    compensator: np.ndarray,
) -> tuple[int, int, int]:
    sample, stamp = take_joint_state(data, previous, True, x)
    if sample <= REPEATED:
        return sample, stamp, 0
    if sample == ANEW:
        reset(memory[0])
    allowed, part = not memory[0].guard.tripped, memory[0].guard.vibration.part
    answer[0].value = estimate_friction(memory[0], x, compensator[0])
    vibrates = compensator[0].guard.least_part < 1.0 and memory[0].guard.vibration.part < part
    if vibrates or (allowed and memory[0].guard.tripped):
        return sample, stamp, REDUCED
    blind = isnan(x[OBSERVED_FRICTION]) and not isnan(x[THETA_DOT])
    return sample, stamp, NOT_OBSERVED if blind else 0


def main() -> None:
    """Entry point of the executable ``friction_observer``."""
    sys.exit(run_node(FrictionObserverNode))
