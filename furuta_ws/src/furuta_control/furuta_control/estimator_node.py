"""Node ``estimator``: measurement → joint_states."""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

from furuta_control.estimation import MEMORY, EstimatorParameters, design_estimator, estimate_state
from furuta_model.block import block
from furuta_model.compiled import compiled
from furuta_model.state import OBSERVED_FRICTION, SIGNALS
from furuta_ros.messages import NANOSECONDS, JointWriter, read_joints, stamp_nanoseconds
from furuta_ros.node import FurutaNode
from furuta_ros.spinning import run_node
from furuta_ros.topics import JOINT_STATES, MEASUREMENT

# Deviation of an interval that does not count, and how many in a row are worth a word.
TOLERANCE = 0.01
MANY = 100


class EstimatorNode(FurutaNode[EstimatorParameters]):
    """Estimates the state from what the sensors say.

    Subscribes to ``measurement``, whose effort of the arm is the torque applied since the last
    one [V]; publishes ``joint_states`` with the measurement's stamp, effort of the arm the
    estimated friction [V] (NaN under method lowpass). A measurement that comes again (same
    stamp) is answered again without a new step.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        self._memory = np.zeros(MEMORY)
        self._measurement = np.zeros(SIGNALS)
        self._estimate = np.zeros(SIGNALS)
        self._writer = JointWriter()
        self._last_stamp = -1
        self._odd_intervals = 0
        super().__init__("estimator", EstimatorParameters, overrides)
        self.watch_parameters(self.parameters_changed)
        self._publisher = self.publish_on(JOINT_STATES)
        self.subscribe_to(MEASUREMENT, self._on_measurement)

    def parameters_changed(self, parameters: EstimatorParameters) -> None:
        """Sample the filters anew; their memory stays."""
        made = design_estimator(parameters)
        self._ideal = made.ideal
        self._estimator = block(made)
        self._interval = parameters.sample_time * NANOSECONDS
        _estimate(self._memory.copy(), self._measurement, self._estimator, self._estimate)

    def _on_measurement(self, message: JointState) -> None:
        stamp = stamp_nanoseconds(message)
        if stamp != self._last_stamp:
            self._read(message)
            _estimate(self._memory, self._measurement, self._estimator, self._estimate)
            filled = self._writer.fill(self._estimate, self._estimate[OBSERVED_FRICTION])
            filled.header.stamp = message.header.stamp
            self._check_interval(stamp - self._last_stamp)
            self._last_stamp = stamp
        self._publisher.publish(self._writer.message)

    def _read(self, message: JointState) -> None:
        """Take the measurement if it has what the estimator needs."""
        read_joints(
            message,
            self._measurement,
            pendulum_speed=self._ideal,
            effort=self.parameters.chosen.needs_applied_torque,
        )

    def _check_interval(self, interval: int) -> None:
        """Tell when the measurements keep coming at another interval than the filter is for."""
        if abs(interval - self._interval) <= TOLERANCE * self._interval:
            self._odd_intervals = 0
            return
        self._odd_intervals += 1
        if self._odd_intervals == MANY:
            self.get_logger().warning(
                f"measurements come every {interval / NANOSECONDS:g} s, but sample_time is "
                f"{self.parameters.sample_time:g} s"
            )


@compiled
def _estimate(
    memory: np.ndarray, measurement: np.ndarray, estimator: np.ndarray, estimate: np.ndarray
) -> None:
    estimate_state(memory, measurement, estimator[0], estimate)


def main() -> None:
    """Entry point of the executable ``estimator``."""
    sys.exit(run_node(EstimatorNode))
