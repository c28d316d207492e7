"""Passivity of LuGre friction: the inequality, and the energy that a motion extracts."""

from __future__ import annotations

import numpy as np
import pytest

from furuta.convergence.friction_passivity import friction_passivity
from furuta_model.friction.lugre import bristle_after, bristle_rate, friction
from furuta_model.friction.parameters import Friction

PAPER = Friction()


def surplus(v: float, z: float, p: Friction) -> float:
    """Fv − Ṡ [V rad/s] of (5), from the model's own functions."""
    return friction(v, z, p) * v - p.sigma0 * z * bristle_rate(v, z, p)


def surplus_over_bound(v: float, p: Friction) -> float:
    """The minimum over all deflections of the bristle, in both directions."""
    least = np.inf
    for direction in (1.0, -1.0):
        reach = (p.alpha0 + p.alpha1) * (1 + direction * p.asymmetry) / p.sigma0
        least = min(
            least,
            *(surplus(direction * v, direction * z, p) for z in np.linspace(-reach, reach, 2001)),
        )
    return least


@pytest.mark.parametrize(
    "p",
    [
        PAPER,
        PAPER._replace(asymmetry=0.3),
        PAPER._replace(viscous=0.05),
        Friction(10.0, 3.0, 0.1, 0.4, 0.5, 0.2),
        Friction(1000.0, 0.2, 0.5, 0.1, 2.0),
    ],
)
def test_speed_up_to_which_friction_dissipates(p: Friction) -> None:
    """Just below it no deflection returns energy, just above it some deflection does."""
    result = friction_passivity(p)
    assert not result.passive
    for part in (0.01, 0.3, 0.9, 0.999):
        assert surplus_over_bound(part * result.up_to_rad_s, p) >= 0.0
    assert surplus_over_bound(1.001 * result.up_to_rad_s, p) < 0.0
    assert surplus_over_bound(100 * result.up_to_rad_s, p) < 0.0


def test_viscous_friction_required() -> None:
    """With σ₂ = σ₁α₁/α₀ no speed returns energy, with less some speed does."""
    needed = friction_passivity(PAPER).viscous_needed
    assert needed == pytest.approx(1.5 * 0.022 / 0.21)
    enough, less = PAPER._replace(viscous=1.0001 * needed), PAPER._replace(viscous=0.99 * needed)
    assert friction_passivity(enough).passive
    assert friction_passivity(enough).up_to_rad_s == np.inf
    for v in np.geomspace(1e-4, 1e4, 60):
        assert surplus_over_bound(float(v), enough) >= 0.0
    assert surplus_over_bound(friction_passivity(less).up_to_rad_s * 1.01, less) < 0.0
    assert friction_passivity(PAPER._replace(sigma1=0.0)).passive
    assert friction_passivity(PAPER._replace(alpha1=0.0)).viscous_needed == 0.0


def energy_of_a_stroke(speed: float, p: Friction) -> float:
    """∫Fv dt [V rad] while the bristle is bent slowly, then moved by a fast stroke of 0.2 mrad."""
    z, energy = 0.0, 0.0
    for v, travel in ((1e-4, 0.03), (speed, 2e-4)):
        dt = travel / v / 3000
        for _ in range(3000):
            after, mean = bristle_after(v, 0.0, z, dt, p)
            energy += v * (dt * (p.sigma0 * mean + p.viscous * v) + p.sigma1 * (after - z))
            z = after
    return energy


def test_the_condition_is_necessary() -> None:
    """If it fails, faster strokes extract more energy; if it holds, they cost more energy."""
    lacking = PAPER._replace(viscous=0.1)
    drawn = [energy_of_a_stroke(speed, lacking) for speed in (1e3, 1e4, 1e5)]
    assert drawn[0] > drawn[1] > drawn[2]
    assert drawn[2] < -0.5
    assert (drawn[2] - drawn[1]) / (drawn[1] - drawn[0]) == pytest.approx(10.0, rel=1e-3)
    enough = PAPER._replace(viscous=0.16)
    spent = [energy_of_a_stroke(speed, enough) for speed in (1e3, 1e4, 1e5)]
    assert 0.0 < spent[0] < spent[1] < spent[2]


def test_one_direction_without_friction() -> None:
    """With an asymmetry of 1, the levels of the other direction double, and so does the speed."""
    alone = friction_passivity(PAPER._replace(asymmetry=1.0)).up_to_rad_s
    assert alone == pytest.approx(2 * friction_passivity(PAPER).up_to_rad_s)
