"""The rigid body: equation (1), compared with mechanics."""

import numpy as np
import pytest
import reference
from scipy.integrate import solve_ivp

from furuta_model.parameters import ParameterError, build
from furuta_model.pendulum import (
    LARGEST_ROTATION,
    FurutaPendulum,
    accelerations,
    energy,
    rotate_slightly,
)

P = FurutaPendulum()
RNG = np.random.default_rng(1)
# Rows of (φ, φ̇, θ, θ̇, torque).
SITUATIONS = RNG.uniform(-1, 1, (50, 5)) * [3, 10, np.pi, 10, 10]


def lagrangian(q: np.ndarray, rate: np.ndarray) -> float:
    """T − V at joint angles q = (φ, θ)."""
    s, c = np.sin(q[1]), np.cos(q[1])
    v, w = rate
    kinetic = P.alpha * v**2 / 2 + P.beta * (w**2 + (s * v) ** 2) / 2 + P.gamma * c * v * w
    return float(kinetic - P.delta * c)


def gradient(function, at: np.ndarray, step: float) -> np.ndarray:
    """Central differences."""
    return np.array([(function(at + e) - function(at - e)) / (2 * step) for e in step * np.eye(2)])


@pytest.mark.parametrize("situation", SITUATIONS[:20])
def test_accelerations_obey_lagrange(situation: np.ndarray) -> None:
    """d/dt ∂L/∂q̇ − ∂L/∂q, differentiated numerically, is the torque on the arm alone."""
    phi, v, theta, w, torque = situation
    q, rate = np.array([phi, theta]), np.array([v, w])
    acceleration = np.array(accelerations(v, theta, w, torque, P))

    def momentum(t: float) -> np.ndarray:
        place = q + rate * t + acceleration * t**2 / 2
        return gradient(lambda r: lagrangian(place, r), rate + acceleration * t, 1.0)

    h = 1e-5
    change = (momentum(h) - momentum(-h)) / (2 * h)
    force = gradient(lambda place: lagrangian(place, rate), q, h)
    assert change - force == pytest.approx([torque, 0.0], abs=1e-6)


def test_accelerations_solve_the_mass_matrix_form() -> None:
    """The closed form agrees with a linear solver, for any admissible inertia."""
    for _, v, theta, w, torque in SITUATIONS:
        alpha, beta, delta = RNG.uniform(0.01, 2, 3)
        p = FurutaPendulum(alpha, beta, RNG.uniform(0.1, 0.95) * np.sqrt(alpha * beta), delta)
        expected = reference.accelerations(v, theta, w, torque, p)
        assert accelerations(v, theta, w, torque, p) == pytest.approx(expected, rel=1e-10)


def test_mirror_image() -> None:
    """Negating all angles, speeds and torques negates the accelerations."""
    for _, v, theta, w, torque in SITUATIONS:
        mirrored = accelerations(-v, -theta, -w, -torque, P)
        assert mirrored == pytest.approx(-np.array(accelerations(v, theta, w, torque, P)))


def test_equilibria() -> None:
    """Upright and hanging are equilibria, unstable and stable."""
    for theta, direction in ((0.0, 1.0), (np.pi, -1.0)):
        assert accelerations(0.0, theta, 0.0, 0.0, P) == pytest.approx((0, 0), abs=1e-12)
        assert direction * accelerations(0.0, theta + 0.01, 0.0, 0.0, P)[1] > 0


def test_energy_is_kinetic_plus_potential() -> None:
    """T + V equals q̇·∂L/∂q̇ − L."""
    for phi, v, theta, w, _ in SITUATIONS:
        q, rate = np.array([phi, theta]), np.array([v, w])
        momentum = gradient(lambda r, q=q: lagrangian(q, r), rate, 1.0)
        expected = rate @ momentum - lagrangian(q, rate)
        assert energy(np.array([phi, v, theta, w]), P) == pytest.approx(expected)


@pytest.mark.parametrize("amplitude", [0.0, 0.5])
def test_power_balance(amplitude: float) -> None:
    """The energy changes by the work of the torque; without torque it is constant."""

    def rate(t: float, x: np.ndarray) -> list[float]:
        _, v, theta, w, _ = x
        torque = amplitude * np.sin(3 * t)
        v_dot, w_dot = accelerations(v, theta, w, torque, P)
        return [v, v_dot, w, w_dot, torque * v]

    start = np.array([0.0, 2.0, 0.3, -1.0, 0.0])
    x = solve_ivp(rate, (0, 5), start, method="DOP853", rtol=1e-11, atol=1e-12).y
    gained = np.array([energy(each, P) for each in x[:4].T]) - energy(start[:4], P)
    assert gained == pytest.approx(x[4], abs=1e-8)
    assert np.ptp(x[2]) > np.pi  # it rotated fully, so the nonlinear terms matter


def test_indefinite_inertia_is_rejected() -> None:
    """αβ ≤ γ² is rejected; the message holds the three values."""
    with pytest.raises(ParameterError, match=r"alpha = 0\.1, beta = 0\.4, gamma = 0\.2"):
        build(FurutaPendulum, {"alpha": 0.1, "beta": 0.4, "gamma": 0.2})
    assert build(FurutaPendulum, {"alpha": 0.1, "beta": 0.4, "gamma": 0.199}).determinant > 0


def test_rotate_is_the_sine_and_cosine_of_the_sum() -> None:
    """To rounding for any angle and any rotation that the series is made for."""
    rng = np.random.default_rng(9)
    for angle in rng.uniform(-np.pi, np.pi, 500):
        turn = rng.choice([-1, 1]) * LARGEST_ROTATION * 10 ** rng.uniform(-9, 0)
        expected = np.sin(angle + turn), np.cos(angle + turn)
        found = rotate_slightly(np.sin(angle), np.cos(angle), turn)
        assert found == pytest.approx(expected, abs=1e-15)
