"""The linear model about upright and pole placement."""

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


def test_linearize_is_the_jacobian() -> None:
    """A and B are finite differences of the nonlinear model about upright."""
    (p,) = pendulums(1)

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


def test_from_linear_inverts_linearize() -> None:
    """Any pendulum is recovered from its linear model."""
    for p in pendulums(20):
        a, b = linearize(p)
        assert from_linear(a[1, 2], a[3, 2], b[1], b[3]) == pytest.approx(p, rel=1e-9)


@pytest.mark.parametrize("p", [P, *pendulums(1)])
@pytest.mark.parametrize(
    "poles",
    [
        DesiredPoles(),
        DesiredPoles(zeta1=0.0),  # on the imaginary axis
        DesiredPoles(zeta1=1.3, zeta2=2.0),  # real
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
