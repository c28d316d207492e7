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
from furuta_ros.messages import RefusedError, read_measurement
from furuta_ros.node import RARELY
from furuta_ros.sample_node import SampleNode
from furuta_ros.spinning import run_node
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import JOINT_STATES, MEASUREMENT
from furuta_ros.wire import (
    ANEW,
    REPEATED,
    new_joint_state,
    take_joint_state,
    write_joint_state,
)

# Relative deviation of an interval that is tolerated.
TOLERANCE = 0.01
# Number of deviating intervals in a row that causes a warning.
WARN_AFTER = 100
# What there is to say about a sample: one bit for each unusable reading, LOST, and DEVIATES if the
# interval is not the sample time.
READINGS, DEVIATES = LOST - 1, LOST << 1


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
        self._estimate = np.zeros(SIGNALS)
        self._deviating_intervals = 0
        self._lost = self._told = False
        self.unusable_readings = 0
        super().__init__("estimator", EstimatorParameters, new_joint_state(), overrides)
        self.watch_parameters(self.parameters_changed)
        self.take_samples(MEASUREMENT, JOINT_STATES)

    def parameters_changed(self, parameters: EstimatorParameters) -> None:
        """Redesign the estimator; its memory is kept."""
        self.compute_with(
            _take,
            self._memory,
            block(design_estimator(parameters)),
            parameters.sample_time * NANOSECONDS,
            self._estimate,
        )

    def read(self, message: JointState, x: np.ndarray) -> None:
        """Read the measurement; refuse it if the torque that the estimator needs is never in it."""
        if self.parameters.chosen.needs_applied_torque and not message.effort:
            raise RefusedError("needs the arm's effort, the torque applied since the last one [V]")
        read_measurement(message, x)

    def report(self, condition: int, interval: int) -> None:
        """Log unusable readings, loss and return of the estimate, and a wrong sample time."""
        phi, phi_dot, theta, theta_dot, _ = self.received.tolist()
        given = f"position {[phi, theta]}, velocity {[phi_dot, theta_dot]}"
        log = self.get_logger()
        lost = bool(condition & LOST)
        if lost and not self._lost:
            text = f"no estimate: the sensors cannot see the state; {given}"
            self._told = self.warn("lost", text, RARELY)
        elif self._lost and not lost:
            if self._told:
                log.info(f"estimating again from {given}")
        elif condition & READINGS:
            self.unusable_readings += 1
            names = ", ".join(name for i, name in enumerate(SIGNAL_NAMES) if condition >> i & 1)
            self.warn(
                "readings",
                f"replaced readings of {names} by predictions in {self.unusable_readings} "
                f"measurements so far; {given}",
            )
        self._lost = lost
        self._deviating_intervals = self._deviating_intervals + 1 if condition & DEVIATES else 0
        if self._deviating_intervals == WARN_AFTER:
            log.warning(
                f"measurements arrive every {interval / NANOSECONDS:g} s, but sample_time is "
                f"{self.parameters.sample_time:g} s"
            )


@compiled
def _take(
    data: bytes,
    previous: int,
    measurement: np.ndarray,
    answer: np.ndarray,
    memory: np.ndarray,
    estimator: np.ndarray,
    sample_time: float,
    estimate: np.ndarray,
) -> tuple[int, int, int]:
    sample, stamp = take_joint_state(data, previous, False, measurement)
    if sample <= REPEATED:
        return sample, stamp, 0
    interval, skipped = stamp - previous, 0
    if sample == ANEW:
        restart(memory[0])
    else:
        skipped = skipped_samples(interval, sample_time)
    if skipped > 0:
        pass_skipped(memory[0], skipped, measurement, estimator[0], estimate)
    estimate_state(memory[0], measurement, estimator[0], estimate)
    write_joint_state(answer[0], stamp, estimate, estimate[OBSERVED_FRICTION])
    unusable = unusable_readings(memory[0])
    deviates = abs(interval - sample_time) > TOLERANCE * sample_time
    return sample, stamp, unusable | (DEVIATES if deviates else 0)


def main() -> None:
    """Entry point of the executable ``estimator``."""
    sys.exit(run_node(EstimatorNode))
