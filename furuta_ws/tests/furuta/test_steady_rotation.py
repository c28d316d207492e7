"""Nyquist curves that start on the negative real axis: the arm rotates."""

import numpy as np
import pytest
import reference
from scipy.integrate import solve_ivp

from furuta.describing_functions.steady_rotation import steady_rotations
from furuta.transfer import FIGURE_4
from furuta_model.friction.laws import ANALYSED_LAWS, friction_law, steady_friction
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum

P = FurutaPendulum()
FREE = {case: FIGURE_4[case] for case in "cd"}
# A Stribeck curve so steep about the rotation of case d that it destabilises it.
STEEP = Friction(alpha0=0.05, alpha1=0.3, stribeck_velocity=0.02)


@pytest.mark.parametrize("feedback", FREE.values(), ids=FREE)
def test_coulomb_rotates_at_fc_over_l2(feedback: tuple[float, ...]) -> None:
    """While sliding forward the arm settles at Fc/l2 with the pendulum upright."""

    def rate(_: float, x: np.ndarray) -> list[float]:
        v_dot, w_dot = reference.accelerations(*x[1:], float(np.dot(feedback, x)) - 0.21, P)
        return [x[1], v_dot, x[3], w_dot]

    for factor in (0.5, 1.5):
        start = [0.0, factor * 0.21 / feedback[1], 0.001, 0.0]
        path = solve_ivp(rate, (0, 20), start, method="Radau", rtol=1e-8, atol=1e-10).y
        assert np.all(path[1] > 0.0)
        assert path[1, -1] == pytest.approx(0.21 / feedback[1], rel=1e-5)
        assert abs(path[2, -1]) < 1e-6
    rotation, back = steady_rotations(P, feedback, friction_law("coulomb"))
    assert rotation == (pytest.approx(0.21 / feedback[1]), True)
    assert back == (pytest.approx(-0.21 / feedback[1]), True)


@pytest.mark.parametrize("kind", ANALYSED_LAWS)
def test_feedback_cancels_friction(kind: str) -> None:
    """l₂v is F at every rotation, with viscous part and unequal levels."""
    law = friction_law(kind, Friction(viscous=0.3, asymmetry=0.2, alpha1=0.1))
    for rotation in steady_rotations(P, FIGURE_4["c"], law):
        v = rotation.rate_rad_s
        assert steady_friction(v, law) == pytest.approx(FIGURE_4["c"][1] * v, rel=1e-9)
    assert len(steady_rotations(P, FIGURE_4["c"], law)) == 2


def test_steep_stribeck_curve_makes_rotation_unstable() -> None:
    """For both laws with the slope."""
    for kind in ("stribeck", "lugre"):
        law = friction_law(kind, STEEP)
        assert [rotation.stable for rotation in steady_rotations(P, FIGURE_4["d"], law)] == [
            False
        ] * 2


def test_no_rotation() -> None:
    """None if φ is fed back, or if l2 is at most the viscous friction."""
    law = friction_law("coulomb", Friction(viscous=0.3))
    for feedback in (FIGURE_4["a"], FIGURE_4["b"], (0, -1, 60, 20), (0, 0.2, 1, 1)):
        assert steady_rotations(P, feedback, law) == ()
