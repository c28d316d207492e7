"""Convergence of the observer, compared with state space, eigenvalues, and simulation."""

import control
import numpy as np
import pytest
import reference
from scipy.integrate import solve_ivp

from furuta.convergence.convergence import convergence
from furuta.convergence.error_loop import ErrorLoop, error_loop, error_loop_for, passive_error
from furuta_model.friction.parameters import Friction
from furuta_model.linear import DesiredPoles, linearize, place_poles
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI
from furuta_model.transfer import FIGURE_4

P, FRICTION = FurutaPendulum(), Friction()
PLACED = tuple(-place_poles(P, DesiredPoles()))
OTHER = FurutaPendulum(0.7, 0.9, 0.5, 1.3)
ARM = np.eye(4)[PHI]
LOOPS = [
    (P, PLACED, FRICTION),
    (P, FIGURE_4["a"], FRICTION),
    (P, tuple(-place_poles(P, DesiredPoles(3, 0.4, 12, 0.9))), Friction(sigma0=500.0, sigma1=3.0)),
    (OTHER, tuple(-place_poles(OTHER, DesiredPoles(2, 0.5, 3, 0.8))), Friction(sigma1=0.0)),
]


def closed(p: FurutaPendulum, feedback: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    a, b = linearize(p)
    return a + np.outer(b, feedback), b


def errors(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction],
    gain: float,
    leak: float = 0.0,
    error: np.ndarray = ARM,
) -> np.ndarray:
    """Matrix (5, 5) of (x, z̃): ẋ = (A + Bl)x − B(σ₀z̃ + σ₁ż̃), ż̃ = −λz̃ + K c·x."""
    p, feedback, friction = loop
    a, b = closed(p, feedback)
    matrix = np.zeros((5, 5))
    matrix[4] = np.append(gain * error, -leak)
    matrix[:4, :4] = a
    matrix[:4] -= np.outer(b, friction.sigma1 * matrix[4])
    matrix[:4, 4] -= friction.sigma0 * b
    return matrix


def rightmost(matrix: np.ndarray) -> float:
    return float(np.max(np.linalg.eigvals(matrix).real))


@pytest.mark.parametrize("loop", LOOPS)
@pytest.mark.parametrize("error", [ARM, np.array([-1.0, -0.7, -8.0, -1.7])])
def test_response_agrees_with_state_space(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction], error: np.ndarray
) -> None:
    """Both ways to build G(s) give python-control's response times the factor of the bristle."""
    p, feedback, friction = loop
    a, b = closed(p, feedback)
    omega = np.geomspace(0.01, 1e3, 60)
    theirs = control.ss(a, b[:, None], error[None], 0)(1j * omega)
    expected = (friction.sigma1 * 1j * omega + friction.sigma0) * theirs
    loops = [error_loop_for(p, feedback, friction, list(error))]
    if error is ARM:
        loops.append(error_loop(p, feedback, friction))
    for g in loops:
        np.testing.assert_allclose(g.at(omega), expected, rtol=1e-7)
        assert g.static_gain == pytest.approx(expected[0].real, rel=1e-3)


def test_loop_of_the_paper() -> None:
    """It has the pendulum's right half plane zero and the static gain −σ₀/l₁."""
    g = error_loop(P, PLACED, FRICTION)
    zero = np.sqrt(P.delta / P.beta)
    assert g.zeros.real == pytest.approx([-80 / 1.5, -zero, zero])
    assert g.static_gain == pytest.approx(-80 / PLACED[0])
    verdict = convergence(g, 0.01, FRICTION)
    assert not verdict.satisfied
    assert "zero 5.09 1/s in the right half plane" in verdict.reason
    assert verdict.smallest_real_part == pytest.approx(g.static_gain)
    assert verdict.at_omega_rad_s == 0.0
    (_, first), (second, end) = verdict.violated_rad_s
    assert (first, second, end) == (
        pytest.approx(3.132, abs=1e-3),
        pytest.approx(13.50, abs=0.01),
        np.inf,
    )
    assert convergence(g, -0.01, FRICTION).violated_rad_s == ((first, second),)


def test_arm_angle_never_satisfies_the_condition() -> None:
    """No random stabilising L with K of either sign or K = 0 satisfies it."""
    rng = np.random.default_rng(9)
    for omega1, zeta1, omega2, zeta2 in rng.uniform(0.2, [30, 1.5, 30, 1.5], (30, 4)):
        feedback = -place_poles(P, DesiredPoles(omega1, zeta1, omega2, zeta2))
        g = error_loop(P, feedback, FRICTION)
        for gain in (1.0, -1.0, 0.0):
            verdict = convergence(g, gain, FRICTION)
            assert not verdict.satisfied
        assert "K = 0" in verdict.reason


@pytest.mark.parametrize("loop", LOOPS)
def test_growth_near_rest_agrees_with_eigenvalues(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction],
) -> None:
    """Any K > 0 is unstable."""
    g = error_loop(*loop)
    for gain in (1e-4, 1e-2, 1.0, 100.0):
        growth = convergence(g, gain, loop[2]).fastest_growth
        assert growth == pytest.approx(rightmost(errors(loop, gain)), rel=1e-6)
        assert growth > 0.0


def test_a_mass_satisfies_the_condition() -> None:
    """The theorem was made for it; the other sign of K does not satisfy it."""
    mass = ErrorLoop(np.array([2.0, 1.0]), np.array([1.0, 3.0, 5.0]))
    assert convergence(mass, 1.0, FRICTION).satisfied
    assert not convergence(mass, -1.0, FRICTION).satisfied


@pytest.mark.parametrize("loop", LOOPS)
@pytest.mark.parametrize("gain", [0.02, -0.02])
def test_a_guaranteed_leak_stabilises(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction], gain: float
) -> None:
    """The leak at the given speed is sufficient; if G(0) is the minimum, less leak is not."""
    p = loop[2]
    verdict = convergence(error_loop(*loop), gain, p)
    leak = p.sigma0 * verdict.holds_above_rad_s / (p.alpha0 + p.alpha1)
    assert leak == pytest.approx(-abs(gain) * verdict.smallest_real_part)
    for factor in (1.001, 2.0, 100.0):
        assert rightmost(errors(loop, gain, factor * leak)) < 0.0
    if verdict.at_omega_rad_s == 0.0:
        assert rightmost(errors(loop, gain, 0.999 * leak)) > 0.0


def test_an_error_that_satisfies_the_condition() -> None:
    """The loop with c·x is SPR according to python-control too, and stable for every K > 0."""
    c = passive_error(P, PLACED, FRICTION)
    assert c is not None
    assert c[PHI] == -1.0
    verdict = convergence(error_loop_for(P, PLACED, FRICTION, list(c)), 1.0, FRICTION)
    assert verdict.satisfied
    a, b = closed(P, PLACED)
    omega = np.concatenate([[0.0], np.geomspace(1e-3, 1e5, 2000)])
    response = control.ss(a, b[:, None], c[None], 0)(1j * omega) * (1.5j * omega + 80)
    assert np.min(response.real) == pytest.approx(verdict.smallest_real_part, rel=1e-4)
    assert verdict.smallest_real_part > 0.0
    for gain in (1e-3, 0.1, 1.0, 100.0):
        assert rightmost(errors((P, PLACED, FRICTION), gain, error=c)) < 0.0
    assert passive_error(P, (0.0, 0.0, 0.0, 0.0), FRICTION) is None


def last_seconds(
    gain: float, error: np.ndarray, bristle: float, tilt: float
) -> tuple[np.ndarray, np.ndarray]:
    """φ and z̃ [rad] in the last 5 s of 40 s of the nonlinear loop with its observer.

    The initial state is the equilibrium for K = 0 with z̃ = ``bristle``, plus ``tilt`` in θ.
    """

    def rate(t: float, y: np.ndarray) -> list[float]:
        x, z, guess = y[:4], y[4], y[5]
        v = x[1]
        leak = FRICTION.sigma0 * abs(v) / reference.level(v, FRICTION)
        guess_rate = v - leak * guess - gain * float(error @ x)
        torque = float(np.dot(PLACED, x)) + FRICTION.sigma0 * guess + FRICTION.sigma1 * guess_rate
        return [*reference.plant_rate(t, np.append(x, z), torque, P, FRICTION), guess_rate]

    start = [FRICTION.sigma0 * bristle / PLACED[0], 0.0, tilt, 0.0, bristle, 0.0]
    path = solve_ivp(rate, (0, 40), start, method="Radau", rtol=1e-6, atol=1e-11, max_step=0.02)
    last = path.t > 35.0
    return path.y[0, last], path.y[4, last] - path.y[5, last]


def test_simulated_convergence() -> None:
    """With K = 0 arm and z̃ keep their offsets; the correction by c·x brings both to zero."""
    arm, bristle = last_seconds(0.0, ARM, 2e-5, 0.0)
    assert arm == pytest.approx(FRICTION.sigma0 * 2e-5 / PLACED[0])
    assert bristle == pytest.approx(2e-5)
    c = passive_error(P, PLACED, FRICTION)
    assert c is not None
    arm, bristle = last_seconds(1.0, c, 2e-5, 0.0)
    assert np.max(np.abs(arm)) < 1e-7
    assert np.max(np.abs(bristle)) < 1e-9


@pytest.mark.parametrize(("gain", "swings"), [(0.01, True), (-0.01, False), (-0.1, True)])
def test_simulated_arm_angle_as_error(gain: float, swings: bool) -> None:
    """The arm comes to rest within the linear limit, and oscillates beyond it or for K > 0."""
    arm, _ = last_seconds(gain, ARM, 2e-4, 1e-4)
    assert (np.ptp(arm) > 1e-3) == swings
    assert (np.max(np.abs(arm)) < 1e-6) != swings


def test_error_decays_with_distance() -> None:
    """With K = 0 the error decays by e over a travel of g/σ₀, independent of the speed."""
    travel = convergence(error_loop(P, PLACED, FRICTION), 0.0, FRICTION).forgetting_travel_rad
    flat = FRICTION._replace(alpha1=0.0)

    def rate(t: float, y: np.ndarray) -> list[float]:
        v = 0.7 * np.sin(9 * t) + 0.2
        rates = [v - flat.sigma0 * abs(v) / flat.alpha0 * z for z in y[:2]]
        return [*rates, abs(v)]

    path = solve_ivp(
        rate, (0, 0.05), [0.002, -0.002, 0], method="Radau", rtol=1e-10, atol=1e-14, max_step=1e-3
    )
    expected = 0.004 * np.exp(-path.y[2] / travel)
    assert path.y[0] - path.y[1] == pytest.approx(expected, rel=1e-5)
