"""Node ``estimator``: measurement → joint_states."""

import sys
from collections.abc import Sequence

import numpy as np
from rclpy.parameter import Parameter

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
from furuta_model.compiled import compiled, for_types_of
from furuta_model.state import SIGNAL_NAMES, SIGNALS
from furuta_ros.messages import typed_joint_state
from furuta_ros.node import RARELY, FurutaNode, LoopPublisher
from furuta_ros.spinning import run_node
from furuta_ros.time_stamps import NANOSECONDS, NEVER, starts_anew
from furuta_ros.topics import JOINT_STATES, MEASUREMENT
from furuta_ros.wire import NO_SIGNALS, Signals, joint_state_bytes, unpack_joint_state

# Relative deviation of an interval that is tolerated.
TOLERANCE = 0.01
# Number of deviating intervals in a row that causes a warning.
WARN_AFTER = 100
LOST_STATE = "no estimate: the sensors cannot see the state"


class EstimatorNode(FurutaNode[EstimatorParameters]):
    """Estimates the state from the measurement.

    Subscribes to ``measurement`` (effort of the arm: the torque applied since the last one [V]);
    publishes ``joint_states`` with the stamp of the measurement and the same effort. If a
    measurement is repeated (same stamp), the last estimate is published again without a new step.
    Readings that cannot be used are replaced and reported. What cannot be estimated is NaN.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        super().__init__("estimator", EstimatorParameters, overrides)
        self._memory = new_memory(EstimatorMemory)
        self._stamp = NEVER
        self._answer = b""
        self._deviating_intervals = 0
        self._lost = self._told = False
        self.unusable_readings = 0
        self.design_by(self._design)
        self._publisher = LoopPublisher(self, JOINT_STATES)
        self.subscribe_to(MEASUREMENT, self.on_measurement)

    def problem(self) -> str:
        """Whether the estimate is lost."""
        return LOST_STATE if self._lost else ""

    def statistics(self) -> dict[str, object]:
        """Also the measurements of which readings were replaced."""
        return super().statistics() | {"unusable readings": self.unusable_readings}

    def _design(self, parameters: EstimatorParameters) -> None:
        """Redesign the estimator; its memory is kept."""
        self._estimator = block(design_estimator(parameters))
        self._step = for_types_of(_step, self._memory, NO_SIGNALS, self._estimator, False, 0)
        self._sample_time = parameters.sample_time * NANOSECONDS

    def on_measurement(self, data: bytes) -> None:
        """Estimate the state and publish it."""
        stamp, measurement = unpack_joint_state(data) or typed_joint_state(data)
        if stamp != self._stamp:
            interval, self._stamp = stamp - self._stamp, stamp
            anew = starts_anew(interval)
            skipped = 0 if anew else self._skipped(interval)
            unusable, estimate = self._step(
                self._memory, measurement, self._estimator, anew, skipped
            )
            if unusable or self._lost:
                self._report(unusable, measurement)
            self._answer = joint_state_bytes(stamp, estimate)
        self._publisher.publish(self._answer, stamp)

    def _skipped(self, interval: int) -> int:
        """Number of samples left out in an interval [ns]; warns if it is not the sample time."""
        deviates = abs(interval - self._sample_time) > TOLERANCE * self._sample_time
        self._deviating_intervals = self._deviating_intervals + 1 if deviates else 0
        if self._deviating_intervals == WARN_AFTER:
            self.get_logger().warning(
                f"measurements arrive every {interval / NANOSECONDS:g} s, but sample_time is "
                f"{self.parameters.sample_time:g} s; a busy computer leaves some out"
            )
        return skipped_samples(interval, self._sample_time) if deviates else 0

    def _report(self, unusable: int, measurement: Signals) -> None:
        """Log unusable readings, and loss and return of the estimate."""
        phi, phi_dot, theta, theta_dot, torque = measurement
        given = f"position {[phi, theta]}, velocity {[phi_dot, theta_dot]}, effort {torque}"
        lost = bool(unusable & LOST)
        if lost and not self._lost:
            self._told = self.warn("lost", f"{LOST_STATE}; {given}", RARELY)
        elif self._lost and not lost:
            if self._told:
                self.get_logger().info(f"estimating again from {given}")
        elif unusable and not lost:
            self.unusable_readings += 1
            names = ", ".join(name for i, name in enumerate(SIGNAL_NAMES) if unusable >> i & 1)
            self.warn(
                "readings",
                f"replaced readings of {names} by predictions in {self.unusable_readings} "
                f"measurements so far; {given}",
            )
        self._lost = lost


@compiled
def _step(
    memory: np.ndarray,
    readings: Signals,
    estimator: np.ndarray,
    anew: bool,
    skipped: int,
) -> tuple[int, Signals]:
    """Unusable readings and the estimate, after ``skipped`` samples without readings."""
    measurement, x = np.array(readings), np.empty(SIGNALS)
    if anew:
        restart(memory[0])
    if skipped > 0:
        pass_skipped(memory[0], skipped, measurement, estimator[0], x)
    estimate_state(memory[0], measurement, estimator[0], x)
    return unusable_readings(memory[0]), (x[0], x[1], x[2], x[3], x[4])


def main() -> None:
    """Entry point of the executable ``estimator``."""
    sys.exit(run_node(EstimatorNode))
