"""The node ``friction_observer``: what it reports."""

from math import nan
from typing import Any

import pytest
from rclpy.parameter import Parameter
from testbench import Bench, joint_state

from furuta_friction import friction_observer_node
from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_ros.topics import FRICTION_ESTIMATE, JOINT_STATES


def test_a_compensation_without_observed_friction_says_what_it_needs(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, capfd: Any
) -> None:
    """An estimator that does not observe friction gives NaN."""
    monkeypatch.setattr(friction_observer_node, "CHECK_PERIOD", 0.1)
    bench.add(FrictionObserverNode([Parameter("compensation", value="disturbance_observer")]))
    estimates, states = bench.collect(FRICTION_ESTIMATE), bench.publisher(JOINT_STATES)
    states.publish(joint_state((0.0, 0.1, 0.0, 0.0), 1_000_000, effort=nan))
    bench.spin(lambda: len(estimates) == 1)
    assert estimates[0].data == 0.0
    bench.spin(lambda: "needs effort (observed friction)" in capfd.readouterr().err)
