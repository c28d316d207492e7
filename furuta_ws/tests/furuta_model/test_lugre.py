"""LuGre friction: equation (5) and its exact solution at constant speed."""

from itertools import product

import numpy as np
import pytest
import reference
from scipy.integrate import solve_ivp

from furuta_model.friction.bristle import SMALL_DECAY
from furuta_model.friction.laws import friction_law, steady_friction
from furuta_model.friction.lugre import (
    bristle_after,
    bristle_rate,
    friction,
    highest_level,
    stribeck_level,
)
from furuta_model.friction.parameters import Friction

UNEQUAL = Friction(viscous=0.3, asymmetry=0.2)
SPEEDS = [0.001, 0.02, 0.05, 0.3, 5.0, 100.0]


@pytest.mark.parametrize("p", [Friction(), UNEQUAL, Friction(asymmetry=-0.5)])
@pytest.mark.parametrize("v", [*SPEEDS, *(-v for v in SPEEDS)])
def test_steady_state_is_the_stribeck_curve(p: Friction, v: float) -> None:
    """After a long time F is g(v) of that direction plus the viscous part."""
    z, mean = bristle_after(v, 0.0, 0.0, 1e4, p)
    expected = np.sign(v) * reference.level(v, p) + p.viscous * v
    assert friction(v, z, p) == pytest.approx(expected)
    assert steady_friction(v, friction_law("lugre", p)) == pytest.approx(expected)
    assert p.sigma0 * mean == pytest.approx(np.sign(v) * reference.level(v, p), rel=0.01)


def test_levels_by_hand() -> None:
    """The curve falls from α₀ + α₁ to α₀; each direction has its own factor."""
    assert stribeck_level(0.0, Friction()) == pytest.approx(0.232)
    assert stribeck_level(0.05, Friction()) == pytest.approx(0.21 + 0.022 / np.e)
    assert stribeck_level(10.0, UNEQUAL) == pytest.approx(0.252)
    assert stribeck_level(-10.0, UNEQUAL) == pytest.approx(0.168)
    assert highest_level(UNEQUAL) == highest_level(UNEQUAL._replace(asymmetry=-0.2))
    assert highest_level(UNEQUAL) == pytest.approx(0.232 * 1.2)
    assert steady_friction(0.0, friction_law("lugre", UNEQUAL)) == 0.0


@pytest.mark.parametrize("rate", [0.0, 1e-6, 1e-2, 1.0, 30.0, 1e3, 1e4, 1e6])
@pytest.mark.parametrize("dt", [1e-5, 1e-3, 0.1, 1.0])
@pytest.mark.parametrize("correction", [0.0, -0.4])
def test_bristle_after_is_exact(rate: float, dt: float, correction: float) -> None:
    """End and mean agree with a stiff solver at tight tolerance for any rate and step."""
    p = Friction(sigma0=1e5, alpha0=0.2, alpha1=0.0)
    v, z = -rate * p.alpha0 / p.sigma0, 1.7e-6
    exact = solve_ivp(
        lambda _, y: [v + correction - rate * y[0], y[0]],
        (0, dt),
        [z, 0.0],
        method="Radau",
        jac=[[-rate, 0], [1, 0]],
        rtol=1e-9,
        atol=1e-17,
    ).y[:, -1]
    scale = abs(z) + abs(v + correction) * dt
    end, mean = bristle_after(v, correction, z, dt, p)
    assert end == pytest.approx(exact[0], rel=1e-7, abs=1e-9 * scale)
    assert mean == pytest.approx(exact[1] / dt, rel=1e-7, abs=1e-9 * scale)


@pytest.mark.parametrize("side", [-1, 1])
def test_no_jump_between_series_and_quotient(side: int) -> None:
    """Both forms give the value of the closed form, computed with more digits, where they meet."""
    p = Friction(alpha1=0.0)
    v, correction, z = 0.03, 0.1, -1e-3
    rate = np.longdouble(p.sigma0) * v / np.longdouble(p.alpha0)
    dt = float(SMALL_DECAY / rate * (1 + side * 1e-9))
    far = (np.longdouble(v) + correction) / rate
    kept = -np.expm1(-rate * dt)
    end, mean = bristle_after(v, correction, z, dt, p)
    assert end == pytest.approx(float(z + (far - z) * kept), rel=1e-12, abs=0)
    assert mean == pytest.approx(float(far - (far - z) * kept / (rate * dt)), rel=1e-11, abs=0)


def test_bound_is_kept() -> None:
    """σ₀|z| stays within the highest level for any sequence of speeds and steps."""
    rng = np.random.default_rng(3)
    for asymmetry, sigma0 in product([0.0, 0.4, -1.0], [80.0, 1e5]):
        p = Friction(sigma0=sigma0, asymmetry=asymmetry)
        bound = 0.232 * (1 + abs(asymmetry)) / sigma0 * (1 + 1e-12)
        z = 0.0
        reached = 0.0
        for _ in range(2000):
            v = rng.choice([-1, 1]) * 10 ** rng.uniform(-6, 3)
            z, mean = bristle_after(v, 0.0, z, 10 ** rng.uniform(-6, -1), p)
            assert abs(z) <= bound
            assert abs(mean) <= bound
            reached = max(reached, abs(z))
        assert reached > 0.8 * bound


def test_odd_without_asymmetry() -> None:
    """With equal levels the two directions are exactly antisymmetric."""
    rng = np.random.default_rng(4)
    p = Friction(viscous=0.1)
    for v, z in rng.normal(0, [0.5, 0.003], (100, 2)):
        assert friction(-v, -z, p) == -friction(v, z, p)
        assert bristle_rate(-v, -z, p) == -bristle_rate(v, z, p)
        assert bristle_after(-v, 0.0, -z, 0.01, p) == tuple(
            -each for each in bristle_after(v, 0.0, z, 0.01, p)
        )


def test_presliding_is_a_spring_and_damper() -> None:
    """Far below the level, F is σ₀ times the displacement plus σ₁ times the speed."""
    p = Friction()
    v, dt = 1e-4, 0.1
    z, _ = bristle_after(v, 0.0, 0.0, dt, p)
    assert friction(v, z, p) == pytest.approx(p.sigma0 * v * dt + p.sigma1 * v, rel=5e-3)
