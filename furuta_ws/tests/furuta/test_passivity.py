"""Passivity condition of the observer, compared with state space, eigenvalues and simulation."""

import control
import numpy as np
import pytest

from furuta.passivity import RealPart, error_loop, passivity, strictly_positive_real
from furuta.transfer import FIGURE_4
from furuta_model.friction.parameters import Friction
from furuta_model.linear import DesiredPoles, linearize, place_poles
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI

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
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction], gain: float, leak: float = 0.0
) -> np.ndarray:
    """Matrix (5, 5) of (x, z̃): ẋ = (A + Bl)x − B(σ₀z̃ + σ₁ż̃), ż̃ = −λz̃ + Kφ."""
    p, feedback, friction = loop
    a, b = closed(p, feedback)
    matrix = np.zeros((5, 5))
    matrix[4] = np.append(gain * ARM, -leak)
    matrix[:4, :4] = a
    matrix[:4] -= np.outer(b, friction.sigma1 * matrix[4])
    matrix[:4, 4] -= friction.sigma0 * b
    return matrix


def rightmost(matrix: np.ndarray) -> float:
    return float(np.max(np.linalg.eigvals(matrix).real))


@pytest.mark.parametrize("loop", LOOPS)
def test_response_agrees_with_state_space(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction],
) -> None:
    """G(s) is python-control's response times the factor of the bristle."""
    p, feedback, friction = loop
    a, b = closed(p, feedback)
    s = 1j * np.geomspace(0.01, 1e3, 60)
    theirs = (friction.sigma1 * s + friction.sigma0) * control.ss(a, b[:, None], ARM[None], 0)(s)
    numerator, denominator = error_loop(p, feedback, friction)
    ours = np.polyval(numerator, s) / np.polyval(denominator, s)
    np.testing.assert_allclose(ours, theirs, rtol=1e-7)


def test_loop_of_the_paper() -> None:
    """It has the pendulum's right half plane zero and the static gain −σ₀/l₁."""
    numerator, denominator = error_loop(P, PLACED, FRICTION)
    zero = np.sqrt(P.delta / P.beta)
    assert sorted(np.roots(numerator).real) == pytest.approx([-80 / 1.5, -zero, zero])
    verdict = passivity(numerator, denominator, 0.01, FRICTION)
    assert not verdict.satisfied
    assert "zero 5.09 1/s in the right half plane" in verdict.reason
    assert verdict.smallest_real_part == pytest.approx(-80 / PLACED[0])
    assert verdict.at_omega_rad_s == 0.0


def test_arm_angle_never_satisfies_the_condition() -> None:
    """No random stabilising L with K of either sign or K = 0 satisfies it."""
    rng = np.random.default_rng(9)
    for omega1, zeta1, omega2, zeta2 in rng.uniform(0.2, [30, 1.5, 30, 1.5], (30, 4)):
        feedback = -place_poles(P, DesiredPoles(omega1, zeta1, omega2, zeta2))
        g = error_loop(P, feedback, FRICTION)
        for gain in (1.0, -1.0, 0.0):
            verdict = passivity(*g, gain, FRICTION)
            assert not verdict.satisfied
        assert "K = 0" in verdict.reason


@pytest.mark.parametrize("loop", LOOPS)
def test_growth_near_rest_agrees_with_eigenvalues(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction],
) -> None:
    """Any K > 0 is unstable."""
    g = error_loop(*loop)
    for gain in (1e-4, 1e-2, 1.0, 100.0):
        growth = passivity(*g, gain, loop[2]).fastest_growth
        assert growth == pytest.approx(rightmost(errors(loop, gain)), rel=1e-6)
        assert growth > 0.0


def test_a_mass_satisfies_the_condition() -> None:
    """The theorem was made for it; the other sign of K does not satisfy it."""
    mass = np.array([2.0, 1.0]), np.array([1.0, 3.0, 5.0])
    assert passivity(*mass, 1.0, FRICTION).satisfied
    assert not passivity(*mass, -1.0, FRICTION).satisfied


@pytest.mark.parametrize("loop", LOOPS)
@pytest.mark.parametrize("gain", [0.02, -0.02])
def test_a_guaranteed_leak_stabilises(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction], gain: float
) -> None:
    """The leak at the given speed is sufficient; if G(0) is the minimum, less leak is not."""
    p = loop[2]
    verdict = passivity(*error_loop(*loop), gain, p)
    leak = p.sigma0 * verdict.holds_above_rad_s / (p.alpha0 + p.alpha1)
    assert leak == pytest.approx(-abs(gain) * verdict.smallest_real_part)
    for factor in (1.001, 2.0, 100.0):
        assert rightmost(errors(loop, gain, factor * leak)) < 0.0
    if verdict.at_omega_rad_s == 0.0:
        assert rightmost(errors(loop, gain, 0.999 * leak)) > 0.0


def masses(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """(σ₁s + σ₀)/(ms² + ds + k), the loop of [6], which is SPR if and only if σ₁d > σ₀m."""
    rng = np.random.default_rng(7)
    return [
        (np.array([s1, s0]), np.array([m, d, k]))
        for m, d, k, s0, s1 in rng.uniform(0.1, [5, 5, 50, 5, 5], (count, 5))
    ]


@pytest.mark.parametrize(("numerator", "denominator"), masses(20))
def test_a_mass_under_pd(numerator: np.ndarray, denominator: np.ndarray) -> None:
    """The result agrees with the analytical condition; both results occur in the sample."""
    (s1, s0), (m, d, _) = numerator, denominator
    assert strictly_positive_real(numerator, denominator)[0] == bool(s1 * d > s0 * m)
    assert {bool(n[0] * p[1] > n[1] * p[0]) for n, p in masses(20)} == {True, False}


@pytest.mark.parametrize(
    ("numerator", "denominator", "reason"),
    [
        ([1.0], [1.0, 1.0], ""),
        ([1.0, 2.0], [1.0, 1.0], ""),
        ([-1.0], [1.0, 1.0], "real part is -1 at ω = 0"),
        ([1.0], [1.0, 0.0], "pole 0 "),
        ([1.0], [1.0, -1.0], "pole 1 "),
        ([1.0, -1.0], [1.0, 3.0, 2.0], "zero 1 "),
        ([1.0], [1.0, 3.0, 2.0], "2 more poles than zeros"),
        # Re G ω² tends to 0: positive real, but not strictly.
        ([1.0, 3.0], [1.0, 3.0, 2.0], "real part is 0 at ω = inf"),
        # Re G touches zero at ω = 1.
        ([1.0, 0.0, 1.0], [1.0, 2.0, 1.0], "real part is "),
    ],
)
def test_each_part_of_the_definition(
    numerator: list[float], denominator: list[float], reason: str
) -> None:
    """One example violates each condition, and two satisfy all of them."""
    verdict, why = strictly_positive_real(np.array(numerator), np.array(denominator))
    assert verdict == (reason == "")
    assert reason in why


def test_infimum_agrees_with_the_curve() -> None:
    """For random stable G the infimum and its frequency agree with a dense curve."""
    rng = np.random.default_rng(8)
    omega = np.concatenate([[0.0], np.geomspace(1e-4, 1e5, 100_000)])
    for _ in range(40):
        denominator = np.poly(-rng.uniform(0.1, 50, 4)).real
        numerator = np.poly(rng.normal(0, 10, rng.integers(1, 5))) * rng.choice([-1.0, 1.0])
        curve = control.tf(numerator, denominator)(1j * omega).real
        part = RealPart.of(numerator, denominator)
        smallest, where = part.smallest
        scale = np.max(np.abs(curve))
        assert smallest <= np.min(curve) + 1e-9 * scale
        assert smallest == pytest.approx(min(np.min(curve), part.at(np.inf)), abs=1e-6 * scale)
        assert part.at(where) == smallest
