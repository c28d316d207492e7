"""The library's view of any linear loop with a friction joint."""

from typing import Any

import control
import numpy as np
import pytest
import scipy.signal

import furuta
from furuta.limit_cycles.joint import Joint
from furuta.loops import ideal_loop
from furuta_model.linear import linearize

A = np.array([[-1.0, 4.0, 1.5], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
B, C = np.array([[1.0], [0.0], [0.0]]), np.array([[1.0, 0.0, 0.0]])
NUMERATOR, DENOMINATOR = [1.0, 0.0, 0.0], [1.0, 1.0, 4.0, 1.5]
FRICTION = furuta.Friction(alpha0=1.0, alpha1=0.5)


@pytest.mark.parametrize(
    "system",
    [
        control.tf(NUMERATOR, DENOMINATOR),
        scipy.signal.StateSpace(A, B, C, np.zeros((1, 1))),
    ],
)
def test_every_form_of_a_loop_has_the_same_cycle(system: Any) -> None:
    given = furuta.friction_joint((A, B, C), FRICTION, "stiction")
    expected = furuta.limit_cycle(given)
    assert expected.kind == "limit_cycle"
    cycle = furuta.limit_cycle(furuta.friction_joint(system, FRICTION, "stiction"))
    assert cycle.peak_to_peak == pytest.approx(expected.peak_to_peak, rel=1e-9)
    assert cycle.period_s == pytest.approx(expected.period_s, rel=1e-9)
    path = expected.trace()
    assert np.ptp(path.state[:, 0]) == pytest.approx(expected.peak_to_peak, rel=1e-6)


@pytest.mark.parametrize("law", ["coulomb", "lugre"])
def test_pendulum_as_a_linear_loop(law: str) -> None:
    """Cycle and prediction are those of the pendulum's own code, linear about upright."""
    pendulum = ideal_loop(law=law, linear=True)
    a, b = linearize(pendulum.body)
    closed = (a + np.outer(b, pendulum.gains), b, [0.0, 1.0, 0.0, 0.0])
    given = furuta.friction_joint(closed, pendulum.law.parameters, law)
    mine, own = furuta.limit_cycle(given), furuta.limit_cycle(pendulum)
    assert mine.peak_to_peak == pytest.approx(own.phi_peak_to_peak_rad, rel=1e-8)
    assert mine.period_s == pytest.approx(own.period_s, rel=1e-8)
    (predicted,), (expected,) = (furuta.predict_cycles(each).cycles for each in (given, pendulum))
    assert predicted == pytest.approx(expected, rel=1e-9)


def test_branch_of_a_loop_reaches_the_end_of_the_range() -> None:
    """Its cycles are the final motions at their values, found in other units."""

    def joint_at(damping: float) -> Joint:
        a = A - (damping - 1.0) * B @ C
        return furuta.friction_joint((a, B, C), FRICTION, "stiction")

    branch = furuta.cycle_branch(joint_at, "damping", 0.8, 1.2, value=1.0)
    first, *_, last = branch.points
    assert [first.event, last.event] == ["end", "end"]
    for value, cycle, _ in (first, last):
        alone = furuta.limit_cycle(joint_at(value))
        assert cycle.peak_to_peak == pytest.approx(alone.peak_to_peak, rel=1e-8)
    assert branch.to_dict()["events"] == [{"event": "end", "damping": v} for v in (0.8, 1.2)]
