"""The node ``estimator``: same results as the core, bad messages rejected."""

from math import isnan, nan
from time import sleep
from typing import Any

from rclpy.parameter import Parameter

from furuta_control.estimator_node import EstimatorNode
from furuta_ros.node import LATCHED, MAX_AGE
from furuta_ros.testing import Bench, joint_state
from furuta_ros.topics import ARMED, JOINT_STATES, MEASUREMENT

MS = 1_000_000


def test_repeated_measurement_is_answered_alike_without_a_step(bench: Bench) -> None:
    """A repeated stamp gives the same estimate, without a new step."""
    bench.add(EstimatorNode())
    states = bench.collect(JOINT_STATES)
    measurement = bench.publisher(MEASUREMENT)
    for stamp, theta in ((0, 0.0), (1, 0.1), (1, 0.1), (2, 0.1)):
        before = len(states)
        measurement.publish(joint_state((0.0, 0.0, theta, nan), stamp))
        bench.spin(lambda before=before: len(states) == before + 1)
    assert states[1] == states[2]
    assert states[2] != states[3]


def test_a_measurement_that_waited_is_ignored_in_real_time(bench: Bench) -> None:
    """It says where the rig was; with simulated time it is answered however late.

    Time beside a rig is not simulated, whoever publishes it.
    """
    node = bench.add(EstimatorNode())
    states = bench.collect(JOINT_STATES)
    measurement = bench.publisher(MEASUREMENT)
    measurement.publish(joint_state((0.0, 0.0, 0.1, nan), 1))
    sleep(2 * MAX_AGE)
    bench.spin(lambda: len(states) == 1)
    rig = bench.probe.create_publisher(ARMED.message, ARMED.name, LATCHED)
    bench.spin(lambda: not node.time_is_simulated())
    bench.probe.destroy_publisher(rig)
    bench.spin(node.time_is_simulated)
    bench.probe.destroy_publisher(bench.clock)
    measurement.publish(joint_state((0.0, 0.0, 0.1, nan), 2))
    sleep(2 * MAX_AGE)
    bench.spin(lambda: node.expired == 1)
    node.time_is_simulated = lambda: True
    measurement.publish(joint_state((0.0, 0.0, 0.1, nan), 3))
    bench.spin(lambda: len(states) == 2)
    assert [each.header.stamp.nanosec for each in states] == [1, 3]


def test_gap_in_the_stamps_starts_anew(bench: Bench) -> None:
    """After a reset the speed from before it is forgotten."""
    bench.add(EstimatorNode())
    states = bench.collect(JOINT_STATES)
    measurement = bench.publisher(MEASUREMENT)
    for k in range(1, 52):
        stamp = k * MS + (200 * MS if k == 51 else 0)
        measurement.publish(joint_state((0.0, 0.0, 0.005 * k, nan), stamp))
        bench.spin(lambda k=k: len(states) == k)
    assert states[-2].velocity[1] > 2.0
    assert states[-1].velocity[1] == 0.0


def test_kalman_needs_the_applied_torque(bench: Bench, capfd: Any) -> None:
    """Without effort method kalman has no estimate, and says what was given; lowpass has one."""
    node = bench.add(EstimatorNode())
    states = bench.collect(JOINT_STATES)
    measurement = bench.publisher(MEASUREMENT)
    message = joint_state((0.0, 0.0, 0.1, nan), 1)
    message.effort = []
    measurement.publish(message)
    bench.spin(lambda: len(states) == 1)
    assert isnan(states[0].velocity[1])
    assert "no estimate" in (warning := capfd.readouterr().err)
    assert "effort nan" in warning
    node.set_parameters([Parameter("method", value="lowpass")])
    message.header.stamp.nanosec += MS
    measurement.publish(message)
    bench.spin(lambda: len(states) == 2)
    assert not isnan(states[1].velocity[1])


def test_single_late_measurements_are_no_other_sample_time(bench: Bench, capfd: Any) -> None:
    """Only a hundred deviating intervals in a row are."""
    bench.add(EstimatorNode())
    states = bench.collect(JOINT_STATES)
    measurement = bench.publisher(MEASUREMENT)

    def send(intervals: list[int], stamp: int) -> None:
        for interval in intervals:
            count, stamp = len(states), stamp + interval * MS
            measurement.publish(joint_state((0.0, 0.0, 0.1, nan), stamp))
            bench.spin(lambda count=count: len(states) == count + 1)

    send([2, 1] * 101, 0)
    assert "measurements arrive" not in capfd.readouterr().err
    send([2] * 101, 303 * MS)
    assert "measurements arrive every 0.002 s" in capfd.readouterr().err
