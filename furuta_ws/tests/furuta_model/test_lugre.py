"""LuGre friction: equation (5) and its exact solution at constant speed."""

from itertools import product

import numpy as np
import pytest
import reference
from scipy.integrate import solve_ivp

from furuta_model.friction.laws import friction_law, steady_friction
from furuta_model.friction.lugre import force, stretched, stribeck_level
from furuta_model.friction.parameters import Friction


def test_steady_state_is_the_stribeck_curve() -> None:
    """After a long time F is g(v) of that direction plus the viscous part."""
    p = Friction(viscous=0.3, asymmetry=0.2)
    for v in (0.001, -0.02, 0.05, -0.3, 5.0, -100.0):
        level = stribeck_level(v, p)
        z, mean, _ = stretched(v, v, 0.0, 1e4, level, p)
        expected = np.sign(v) * reference.level(v, p) + p.viscous * v
        assert force(v, z, level, p) == pytest.approx(expected)
        assert steady_friction(v, friction_law("lugre", p)) == pytest.approx(expected)
        assert p.sigma0 * mean == pytest.approx(np.sign(v) * reference.level(v, p), rel=0.01)


@pytest.mark.parametrize("rate", [0.0, 1e-2, 30.0, 1e4])
@pytest.mark.parametrize("dt", [1e-3, 1.0])
def test_stretched_is_exact(rate: float, dt: float) -> None:
    """End and mean agree with a stiff solver at tight tolerance for any rate and step."""
    correction = -0.4
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
    end, mean, _ = stretched(v, v + correction, z, dt, stribeck_level(v, p), p)
    assert end == pytest.approx(exact[0], rel=1e-7, abs=1e-9 * scale)
    assert mean == pytest.approx(exact[1] / dt, rel=1e-7, abs=1e-9 * scale)


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
            dt = 10 ** rng.uniform(-6, -1)
            z, mean, _ = stretched(v, v, z, dt, stribeck_level(v, p), p)
            assert abs(z) <= bound
            assert abs(mean) <= bound
            reached = max(reached, abs(z))
        assert reached > 0.8 * bound
