"""The linear model about upright and pole placement."""

from fractions import Fraction

import control
import numpy as np
import pytest

from furuta_model.linear import DesiredPoles, from_linear, linearize, place_poles
from furuta_model.pendulum import FurutaPendulum, accelerations

P = FurutaPendulum()


def pendulums(count: int) -> list[FurutaPendulum]:
    """Random admissible pendulums."""
    rng = np.random.default_rng(2)
    return [
        FurutaPendulum(alpha, beta, rng.uniform(0.1, 0.95) * np.sqrt(alpha * beta), delta)
        for alpha, beta, delta in rng.uniform(0.01, 2, (count, 3))
    ]


@pytest.mark.parametrize("p", [P, *pendulums(5)])
def test_linearize_is_the_jacobian(p: FurutaPendulum) -> None:
    """A and B are finite differences of the nonlinear model about upright."""

    def rate(x: np.ndarray, torque: float) -> np.ndarray:
        v_dot, w_dot = accelerations(x[1], x[2], x[3], torque, p)
        return np.array([x[1], v_dot, x[3], w_dot])

    h, rest = 1e-6, np.zeros(4)
    a, b = linearize(p)
    columns = [(rate(e, 0.0) - rate(-e, 0.0)) / (2 * h) for e in h * np.eye(4)]
    assert np.allclose(a, np.transpose(columns), rtol=1e-8, atol=1e-8)
    assert np.allclose(b, (rate(rest, h) - rate(rest, -h)) / (2 * h), rtol=1e-8)


def test_rig_numbers() -> None:
    """The default pendulum has exactly the identified a23, a43, b21, b41 of the rig."""
    a, b = linearize(P)
    assert (a[1, 2], a[3, 2], b[1], b[3]) == pytest.approx((-11, 33, 45, -29), rel=1e-12)


def test_from_linear_rig_numbers() -> None:
    """The four numbers of the rig give α, β, γ, δ as exact fractions by Cramer's rule."""
    a23, a43, b21, b41 = (Fraction(each) for each in (-11, 33, 45, -29))
    delta = a23 / b41
    determinant = 1 / (a43 / delta * b21 - b41**2)
    expected = [a43 / delta * determinant, b21 * determinant, -b41 * determinant, delta]
    assert expected == [Fraction(87, 3074), Fraction(45, 3074), Fraction(29, 3074), delta]
    found = from_linear(-11.0, 33.0, 45.0, -29.0)
    assert found == pytest.approx([float(each) for each in expected], rel=1e-12)


def test_from_linear_inverts_linearize() -> None:
    """Any pendulum is recovered from its linear model."""
    for p in pendulums(20):
        a, b = linearize(p)
        assert from_linear(a[1, 2], a[3, 2], b[1], b[3]) == pytest.approx(p, rel=1e-9)


def test_open_loop_poles() -> None:
    """The poles of (3) are 0, 0 and ±√a43."""
    poles = np.sort(np.linalg.eigvals(linearize(P)[0]).real)
    assert poles == pytest.approx([-np.sqrt(33), 0, 0, np.sqrt(33)], abs=1e-6)


def test_polynomial() -> None:
    """(s² + 9.8s + 49)(s² + 7s + 25), expanded by hand."""
    assert DesiredPoles().polynomial == pytest.approx([1, 16.8, 142.6, 588, 1225])


@pytest.mark.parametrize("p", [P, *pendulums(3)])
@pytest.mark.parametrize(
    "poles",
    [
        DesiredPoles(),
        DesiredPoles(zeta1=0.0),  # on the imaginary axis
        DesiredPoles(zeta1=1.3, zeta2=2.0),  # real
        DesiredPoles(omega1=20.0, omega2=0.5),
    ],
)
def test_place_poles(p: FurutaPendulum, poles: DesiredPoles) -> None:
    """The closed loop has the desired poles, and L agrees with python-control."""
    a, b = linearize(p)
    assert np.linalg.matrix_rank(control.ctrb(a, b[:, None])) == 4
    wanted = [
        root
        for omega, zeta in (poles[:2], poles[2:])
        for root in omega * (-zeta + np.array([1, -1]) * np.emath.sqrt(zeta**2 - 1))
    ]
    gain = place_poles(p, poles)
    assert np.poly(a - np.outer(b, gain)) == pytest.approx(np.poly(wanted), rel=1e-6, abs=1e-6)
    assert gain == pytest.approx(np.ravel(control.place(a, b[:, None], wanted)), rel=1e-6)


def test_viscous_friction_is_part_of_the_model() -> None:
    """The poles are the desired ones on the model with viscous friction, for the same command."""
    viscous, poles = 0.25, DesiredPoles()
    a, b = linearize(P, viscous)
    rigid, _ = linearize(P)
    assert a @ [0.0, 2.0, 0.1, 0.3] == pytest.approx(rigid @ [0, 2, 0.1, 0.3] - b * viscous * 2.0)
    gain = place_poles(P, poles, viscous)
    assert np.poly(a - np.outer(b, gain)) == pytest.approx(poles.polynomial, rel=1e-6)


def test_place_double_poles() -> None:
    """Two equal pairs, which python-control's place rejects and its acker accepts."""
    a, b = linearize(P)
    gain = place_poles(P, DesiredPoles(6.0, 0.7, 6.0, 0.7))
    root = 6 * (-0.7 + 1j * np.sqrt(1 - 0.49))
    wanted = [root, root.conjugate()] * 2
    assert gain == pytest.approx(np.ravel(control.acker(a, b[:, None], wanted)), rel=1e-6)
