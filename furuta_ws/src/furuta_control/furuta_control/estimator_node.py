"""Node ``estimator``: measurement → joint_states."""

import sys
from collections.abc import Sequence

import numpy as np
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

from furuta_control.estimation import (
    LOST,
    EstimatorMemory,
    EstimatorParameters,
    design_estimator,
    estimate_state,
    pass_skipped,
    restart,
    skipped_samples,
    unusable_readings,
)
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled
from furuta_model.state import OBSERVED_FRICTION, SIGNAL_NAMES, SIGNALS
from furuta_ros.loop_publisher import LoopPublisher
from furuta_ros.messages import JointWriter, RefusedError, read_measurement
from furuta_ros.node import WARNING_PERIOD
from furuta_ros.sample_node import SampleNode
from furuta_ros.spinning import run_node
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import JOINT_STATES, MEASUREMENT

# Relative deviation of an interval that is tolerated.
TOLERANCE = 0.01
# Number of deviating intervals in a row that causes a warning.
WARN_AFTER = 100


class EstimatorNode(SampleNode[EstimatorParameters]):
    """Estimates the state from the measurement.

    Subscribes to ``measurement`` (effort of the arm: the torque applied since the last one [V]);
    publishes ``joint_states`` with the stamp of the measurement (effort of the arm: the observed
    friction [V], NaN with method lowpass). If a measurement is repeated (same stamp), the last
    estimate is published again without a new step. Readings that cannot be used are replaced and
    reported. What cannot be estimated is NaN. An estimate that has become too old is not published.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        self._memory = new_memory(EstimatorMemory)
        self._measurement, self._estimate = np.zeros(SIGNALS), np.zeros(SIGNALS)
        self._writer = JointWriter()
        self._deviating_intervals = 0
        self._unusable = 0
        self.unusable_readings = 0
        super().__init__("estimator", EstimatorParameters, overrides)
        self.watch_parameters(self.parameters_changed)
        self._publisher = LoopPublisher(self, JOINT_STATES)
        self.take_samples(MEASUREMENT)

    def parameters_changed(self, parameters: EstimatorParameters) -> None:
        """Redesign the estimator; its memory is kept."""
        self._estimator = block(design_estimator(parameters))
        self._interval = parameters.sample_time * NANOSECONDS
        _estimate(self._memory.copy(), 0, self._measurement, self._estimator, self._estimate)

    def read(self, message: JointState) -> None:
        """Read the measurement; refuse it if the torque that the estimator needs is never in it."""
        if self.parameters.chosen.needs_applied_torque and not message.effort:
            raise RefusedError("needs the arm's effort, the torque applied since the last one [V]")
        read_measurement(message, self._measurement)

    def reset(self) -> None:
        """Forget the motion."""
        restart(self._memory[0])

    def step(self, interval: int, continues: bool) -> None:
        """Estimate the state, after samples that were skipped."""
        skipped = skipped_samples(interval, self._interval) if continues else 0
        unusable = _estimate(
            self._memory, skipped, self._measurement, self._estimator, self._estimate
        )
        if unusable != self._unusable or unusable > 0:
            self._report(unusable)
        self._check_interval(interval)
        self._writer.stamp(self.stamp)
        self._writer.fill(self._estimate, self._estimate[OBSERVED_FRICTION])
        self.answer()

    def answer(self) -> None:
        """Publish the estimate, unless it is too old."""
        if self.message_age.answerable():
            self._publisher.publish(self._writer.message, self.stamp)

    def _report(self, unusable: int) -> None:
        """Log readings that cannot be used, and the loss and return of the estimate."""
        phi, phi_dot, theta, theta_dot, _ = self._measurement.tolist()
        given = f"position {[phi, theta]}, velocity {[phi_dot, theta_dot]}"
        log = self.get_logger()
        if unusable == LOST:
            log.warning(f"no estimate: the sensors cannot see the state; {given}")
        elif self._unusable == LOST:
            log.info(f"estimating again from {given}")
        elif unusable:
            self.unusable_readings += 1
            names = ", ".join(name for i, name in enumerate(SIGNAL_NAMES) if unusable >> i & 1)
            log.warning(
                f"replaced readings of {names} by predictions in {self.unusable_readings} "
                f"measurements so far; {given}",
                throttle_duration_sec=WARNING_PERIOD,
            )
        self._unusable = unusable

    def _check_interval(self, interval: int) -> None:
        """Warn if measurements keep arriving at an interval other than the sample time."""
        if abs(interval - self._interval) <= TOLERANCE * self._interval:
            self._deviating_intervals = 0
            return
        self._deviating_intervals += 1
        if self._deviating_intervals == WARN_AFTER:
            self.get_logger().warning(
                f"measurements arrive every {interval / NANOSECONDS:g} s, but sample_time is "
                f"{self.parameters.sample_time:g} s"
            )


@compiled
def _estimate(
    memory: np.ndarray,
    skipped: int,
    measurement: np.ndarray,
    estimator: np.ndarray,
    estimate: np.ndarray,
) -> int:
    """One sample; return the readings that were replaced."""
    if skipped:
        pass_skipped(memory[0], skipped, measurement, estimator[0], estimate)
    estimate_state(memory[0], measurement, estimator[0], estimate)
    return unusable_readings(memory[0])


def main() -> None:
    """Entry point of the executable ``estimator``."""
    sys.exit(run_node(EstimatorNode))
