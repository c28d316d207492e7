"""The rigid body: equation (1), compared with mechanics."""

import numpy as np
import pytest
import reference
from scipy.integrate import solve_ivp

from furuta_model.parameters import ParameterError, build
from furuta_model.pendulum import (
    FurutaPendulum,
    accelerations,
)

P = FurutaPendulum()
RNG = np.random.default_rng(1)
# Rows of (φ, φ̇, θ, θ̇, torque).
SITUATIONS = RNG.uniform(-1, 1, (50, 5)) * [3, 10, np.pi, 10, 10]


def test_accelerations_solve_the_mass_matrix_form() -> None:
    """The closed form agrees with a linear solver, for any admissible inertia."""
    for _, v, theta, w, torque in SITUATIONS:
        alpha, beta, delta = RNG.uniform(0.01, 2, 3)
        p = FurutaPendulum(alpha, beta, RNG.uniform(0.1, 0.95) * np.sqrt(alpha * beta), delta)
        expected = reference.accelerations(v, theta, w, torque, p)
        assert accelerations(v, theta, w, torque, p) == pytest.approx(expected, rel=1e-10)


def test_power_balance() -> None:
    """The energy changes by the work of the torque."""

    def rate(t: float, x: np.ndarray) -> list[float]:
        _, v, theta, w, _ = x
        torque = 0.5 * np.sin(3 * t)
        v_dot, w_dot = accelerations(v, theta, w, torque, P)
        return [v, v_dot, w, w_dot, torque * v]

    start = np.array([0.0, 2.0, 0.3, -1.0, 0.0])
    x = solve_ivp(rate, (0, 5), start, method="DOP853", rtol=1e-11, atol=1e-12).y
    gained = np.array([reference.energy(each, P) for each in x[:4].T]) - reference.energy(
        start[:4], P
    )
    assert gained == pytest.approx(x[4], abs=1e-8)
    assert np.ptp(x[2]) > np.pi  # it rotated fully, so the nonlinear terms matter


def test_indefinite_inertia_is_rejected() -> None:
    """αβ ≤ γ² is rejected; the message holds the three values."""
    with pytest.raises(ParameterError, match=r"alpha = 0\.1, beta = 0\.4, gamma = 0\.2"):
        build(FurutaPendulum, {"alpha": 0.1, "beta": 0.4, "gamma": 0.2})
    assert build(FurutaPendulum, {"alpha": 0.1, "beta": 0.4, "gamma": 0.199}).determinant > 0
