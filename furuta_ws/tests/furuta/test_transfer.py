"""G(s) of equation (10), compared with state space and sampled curves."""

import numpy as np
import pytest

from furuta.transfer import (
    FIGURE_4,
    Transfer,
    transfer,
)
from furuta_model.linear import DesiredPoles, linearize, place_poles
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI_DOT

P = FurutaPendulum()
OTHER = FurutaPendulum(0.7, 0.9, 0.5, 1.3)
PLACED = tuple(-place_poles(P, DesiredPoles()))
FEEDBACKS = [PLACED, *FIGURE_4.values(), (-3.0, 2.0, 5.0, -1.0), (0.0, -2.0, 1.0, 4.0)]


@pytest.mark.parametrize("feedback", FEEDBACKS)
def test_equation_10_is_the_state_space(feedback: tuple[float, ...]) -> None:
    """G(jω) is C(jω − A − Bl)⁻¹B, because −F acts where u does; also whether it is stable."""
    for p in (P, OTHER):
        a, b = linearize(p)
        closed = a + np.outer(b, feedback)
        g = transfer(p, feedback)
        for omega in np.geomspace(0.01, 1e3, 30):
            expected = np.linalg.solve(1j * omega * np.eye(4) - closed, b)[PHI_DOT]
            assert complex(g.at(omega)) == pytest.approx(expected, rel=1e-9)
        poles = list(np.linalg.eigvals(closed))
        if feedback[0] == 0.0:  # φ is no state of G
            poles.remove(min(poles, key=abs))
        assert g.stable == bool(np.all(np.real(poles) < -1e-9))


def curve_crossings(g: Transfer) -> list[float]:
    """ω at which a finely sampled curve crosses the negative real axis."""
    omega = np.geomspace(1e-4, 1e4, 400_000)
    values = g.at(omega)
    sign = np.flatnonzero(np.diff(np.sign(values.imag)) != 0)
    return [float(omega[i]) for i in sign if values.real[i] < 0.0]


def test_crossings_are_those_of_the_curve() -> None:
    """No crossing of the negative real axis is missed or added, for random feedbacks."""
    rng = np.random.default_rng(5)
    counts = set()
    for feedback in [*FEEDBACKS, *rng.normal(0, [5, 5, 30, 10], (40, 4))]:
        g = transfer(P, feedback)
        found = [each for each in g.crossings if each.omega_rad_s > 0.0]
        assert [each.omega_rad_s for each in found] == pytest.approx(curve_crossings(g), rel=1e-4)
        for omega, real in found:
            assert complex(g.at(omega)) == pytest.approx(real, rel=1e-9)
        counts.add(len(found))
    assert counts == {0, 1, 2}


def test_figure_4() -> None:
    """Case a crosses once in an oscillation, b never, c and d at ω = 0 with G(0) = −1/l2."""
    a, b, c, d = (transfer(P, feedback) for feedback in FIGURE_4.values())
    (crossing,) = a.crossings
    assert crossing == pytest.approx((3.0570, -1.71373), rel=1e-4)
    assert b.crossings == ()
    assert b.static_gain == float("inf")
    assert c.crossings == ((0.0, -1.0),)
    assert d.crossings == ((0.0, pytest.approx(-1 / 7)),)
    assert complex(d.at(1e-6)) == pytest.approx(-1 / 7, rel=1e-4)
    assert [each.stable for each in (a, b, c, d)] == [True, False, True, True]
    assert a.static_gain == 0.0


def test_stable_loop_with_arm_feedback_crosses_once() -> None:
    """Roots of real and imaginary part interlace, so any stable l1 ≠ 0 gives one limit cycle."""
    rng = np.random.default_rng(6)
    for omega1, omega2, zeta1, zeta2 in rng.uniform(0.2, [20, 20, 1.5, 1.5], (50, 4)):
        gain = place_poles(P, DesiredPoles(omega1, zeta1, omega2, zeta2))
        assert len(transfer(P, -gain).crossings) == 1
