"""The node ``friction_observer``: what it reports."""

from math import pi, sin

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.parameter import Parameter
from testbench import Bench, joint_state

from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_ros.topics import DIAGNOSTICS, FRICTION_ESTIMATE, JOINT_STATES


def test_a_vibration_is_reported_on_diagnostics(bench: Bench) -> None:
    """Observed friction that vibrates at 50 Hz reduces the compensation, with the reason."""
    bench.add(FrictionObserverNode([Parameter("compensation", value="disturbance_observer")]))
    estimates, reports = bench.collect(FRICTION_ESTIMATE), bench.collect(DIAGNOSTICS)
    states = bench.publisher(JOINT_STATES)
    for k in range(200):
        friction = 0.2 * sin(2 * pi * 50 * k * 1e-3)
        states.publish(joint_state((0.0, 0.1, 0.0, 0.0), (k + 1) * 1_000_000, effort=friction))
        bench.spin(lambda k=k: len(estimates) == k + 1)
    bench.spin(lambda: bool(reports))
    (status,) = reports[0].status
    assert status.name == "friction_observer: reduction"
    assert status.level == DiagnosticStatus.WARN
    assert "has reduced the friction compensation to 25%" in status.message
