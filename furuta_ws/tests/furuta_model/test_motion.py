"""Integration of the plant over a sample, compared with an implicit solver."""

import numpy as np
import pytest
import reference

from furuta_model.friction.laws import friction_law
from furuta_model.friction.parameters import Friction
from furuta_model.integration import advance, substeps_for
from furuta_model.pendulum import FurutaPendulum

BODY = FurutaPendulum()
DT = 1e-3


def advanced(
    start: list[float], torque: float, seconds: float, lugre: Friction, dt: float = DT
) -> np.ndarray:
    """States (n + 1, 5) at every sample."""
    x, law = np.array(start), friction_law("lugre", lugre)
    states = [x.copy()]
    for _ in range(round(seconds / dt)):
        advance(x, torque, dt, substeps_for(dt, BODY, lugre), BODY, law)
        states.append(x.copy())
    return np.array(states)


@pytest.mark.parametrize("lugre", [Friction(), Friction(viscous=0.02, asymmetry=0.3)])
def test_stick_and_slip_match_the_implicit_solver(lugre: Friction) -> None:
    """A hanging pendulum moves the arm through slips and stops; 3 s end where Radau ends."""
    start = [0.0, 0.0, np.pi - 1.5, 0.0, 0.0]
    states = advanced(start, 0.05, 3.0, lugre)
    moving = np.abs(states[:, 1]) > 0.05
    assert 0.1 < moving.mean() < 0.9
    expected = reference.plant_after(np.array(start), 0.05, 3.0, BODY, lugre)
    assert states[-1, :4] == pytest.approx(expected[:4], abs=1e-3)
    assert lugre.sigma0 * states[-1, 4] == pytest.approx(lugre.sigma0 * expected[4], abs=1e-3)


def test_bounded_at_long_samples_and_high_speed() -> None:
    """At 10 ms and 100 rad/s friction only dissipates energy; explicit Euler would diverge."""
    start = [0.0, 100.0, 0.1, 0.0, 0.0]
    states = advanced(start, 0.0, 20.0, Friction(), dt=0.01)
    energies = np.array([reference.energy(x, BODY) for x in states])
    assert np.all(np.isfinite(states))
    assert energies[-1] < 0.2 * energies[0]
    assert energies.max() < 1.01 * energies[0]
    assert 80 * np.abs(states[:, 4]).max() < 0.232 * (1 + 1e-9)


@pytest.mark.parametrize("sigma1", [1.5, 20.0])
def test_stiff_bristle(sigma1: float) -> None:
    """With σ₀ = 1e5 the usual substeps still follow the motion of a stuck arm."""
    lugre = Friction(sigma0=1e5, sigma1=sigma1)
    start = [0.0, 0.0, 0.05, 0.0, 0.0]
    states = advanced(start, 0.1, 0.4, lugre)
    expected = reference.plant_after(np.array(start), 0.1, 0.4, BODY, lugre)
    assert np.abs(states[:, 0]).max() < 1e-4  # it is stuck
    assert states[-1, 2:4] == pytest.approx(expected[2:4], rel=1e-4)
    assert lugre.sigma0 * states[-1, 4] == pytest.approx(lugre.sigma0 * expected[4], abs=1e-3)
