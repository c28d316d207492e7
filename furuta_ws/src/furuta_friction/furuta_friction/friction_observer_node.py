"""Node ``friction_observer``: joint_states → friction_estimate."""

import sys
from collections.abc import Sequence
from math import isnan

import numpy as np
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

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
from furuta_model.state import OBSERVED_FRICTION, SIGNALS, THETA_DOT
from furuta_ros.loop_publisher import LoopPublisher
from furuta_ros.messages import read_joints
from furuta_ros.node import WARNING_PERIOD
from furuta_ros.sample_node import SampleNode
from furuta_ros.spinning import run_node
from furuta_ros.topics import FRICTION_ESTIMATE, JOINT_STATES

# Time between two checks of the adapted levels [s].
LEVELS_PERIOD = 5.0


class FrictionObserverNode(SampleNode[ObserverParameters]):
    """Estimates the friction in the arm's joint.

    Subscribes to ``joint_states``, publishes ``friction_estimate`` [V], one for each state. If a
    state is repeated (same stamp), the last estimate is published again without a new step.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        self._memory = new_memory(CompensationMemory)
        self._x = np.zeros(SIGNALS)
        self._estimate = Float64()
        self._applied: ObserverParameters | None = None
        super().__init__("friction_observer", ObserverParameters, overrides)
        self.watch_parameters(self.parameters_changed)
        self._publisher = LoopPublisher(self, FRICTION_ESTIMATE)
        self.take_samples(JOINT_STATES)
        self.steady_timer(LEVELS_PERIOD, self._check_levels)

    def parameters_changed(self, parameters: ObserverParameters) -> None:
        """Switch to the compensator that the parameters describe; the memory is kept.

        After a change a compensation that the guard has switched off is tried again.
        """
        if parameters != self._applied:
            allow(self._memory[0])
        self._applied = parameters
        self._compensator = block(design_compensator(parameters))
        _estimate(self._memory.copy(), self._x, self._compensator)

    def read(self, message: JointState) -> None:
        """Read the state."""
        read_joints(message, self._x, partly=True)

    def reset(self) -> None:
        """Forget the motion."""
        reset(self._memory[0])

    def step(self, interval: int, continues: bool) -> None:
        """Estimate the friction."""
        self._check_observed_friction()
        before = switched_off(self._memory)
        self._estimate.data = _estimate(self._memory, self._x, self._compensator)
        if switched_off(self._memory) and not before:
            self.get_logger().error(self.parameters.switch_off_reason)
        self.answer()

    def answer(self) -> None:
        """Publish the estimate."""
        self._publisher.publish(self._estimate, self.stamp)

    def _check_levels(self) -> None:
        if beyond_adaptation(self._memory, self.parameters):
            self.get_logger().warning(
                "compensation adaptive: a level is at its limit, a third or three times what "
                "alpha0 and alpha1 say; the friction is not as the parameters describe it"
            )

    def _check_observed_friction(self) -> None:
        """Warn if the compensation needs the observed friction and does not get it."""
        chosen = self.parameters.chosen
        if not chosen.needs_observed_friction or isnan(self._x[THETA_DOT]):
            return
        if isnan(self._x[OBSERVED_FRICTION]):
            self.get_logger().warning(
                f"compensation {chosen.name} needs effort (observed friction) in joint_states; "
                "use an estimator that observes it (method kalman)",
                throttle_duration_sec=WARNING_PERIOD,
            )


@compiled
def _estimate(memory: np.ndarray, x: np.ndarray, compensator: np.ndarray) -> float:
    return estimate_friction(memory[0], x, compensator[0])


def main() -> None:
    """Entry point of the executable ``friction_observer``."""
    sys.exit(run_node(FrictionObserverNode))
