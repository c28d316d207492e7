"""Passivity condition of the observer, compared with state space, eigenvalues and simulation."""

import numpy as np
import pytest

from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.passivity import Passivity, error_loop, observer_passivity
from furuta.transfer import FIGURE_4
from furuta_model.friction.laws import friction_law
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


def errors(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction], gain: float, leak: float = 0.0
) -> np.ndarray:
    """Matrix (5, 5) of (x, z̃): ẋ = (A + Bl)x − B(σ₀z̃ + σ₁ż̃), ż̃ = −λz̃ + Kφ."""
    p, feedback, friction = loop
    a, b = linearize(p)
    matrix = np.zeros((5, 5))
    matrix[4] = np.append(gain * ARM, -leak)
    matrix[:4, :4] = a + np.outer(b, feedback)
    matrix[:4] -= np.outer(b, friction.sigma1 * matrix[4])
    matrix[:4, 4] -= friction.sigma0 * b
    return matrix


def verdict(loop: tuple[FurutaPendulum, tuple[float, ...], Friction], gain: float) -> Passivity:
    p, feedback, friction = loop
    return observer_passivity(IdealLoop(p, friction_law("lugre", friction), *feedback), gain)


def rightmost(matrix: np.ndarray) -> float:
    return float(np.max(np.linalg.eigvals(matrix).real))


def test_loop_of_the_paper() -> None:
    """It has the pendulum's right half plane zero and the static gain −σ₀/l₁."""
    numerator, _ = error_loop(P, PLACED, FRICTION)
    zero = np.sqrt(P.delta / P.beta)
    assert sorted(np.roots(numerator).real) == pytest.approx([-80 / 1.5, -zero, zero])
    found = verdict((P, PLACED, FRICTION), 0.01)
    assert not found.satisfied
    assert "zero 5.09 1/s in the right half plane" in found.reason
    assert found.smallest_real_part == pytest.approx(-80 / PLACED[0])
    assert found.at_omega_rad_s == 0.0
    assert "K = 0" in verdict((P, PLACED, FRICTION), 0.0).reason


@pytest.mark.parametrize("loop", LOOPS)
def test_growth_near_rest_agrees_with_eigenvalues(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction],
) -> None:
    """Any K > 0 is unstable."""
    for gain in (1e-4, 1e-2, 1.0, 100.0):
        growth = verdict(loop, gain).fastest_growth
        assert growth == pytest.approx(rightmost(errors(loop, gain)), rel=1e-6)
        assert growth > 0.0


@pytest.mark.parametrize("loop", LOOPS)
def test_a_guaranteed_leak_stabilises(
    loop: tuple[FurutaPendulum, tuple[float, ...], Friction],
) -> None:
    """The leak at the given speed is sufficient; if G(0) is the minimum, less leak is not."""
    gain = 0.02
    p, found = loop[2], verdict(loop, gain)
    leak = p.sigma0 * found.holds_above_rad_s / (p.alpha0 + p.alpha1)
    assert leak == pytest.approx(-abs(gain) * found.smallest_real_part)
    for factor in (1.001, 2.0, 100.0):
        assert rightmost(errors(loop, gain, factor * leak)) < 0.0
    if found.at_omega_rad_s == 0.0:
        assert rightmost(errors(loop, gain, 0.999 * leak)) > 0.0
