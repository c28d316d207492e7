"""Level and presliding are learned from a motion whose friction is integrated here."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from furuta_friction.compensation import (
    CompensationMemory,
    ObserverParameters,
    design_compensator,
    estimate_friction,
    reset,
)
from furuta_friction.learned_friction import FASTEST, SLOWEST, LearningParameters
from furuta_model.block import new_memory
from furuta_model.friction.parameters import Friction
from furuta_model.late_drive import LateDrive

DT, SUBSTEPS, INVERSE_INERTIA = 1e-3, 10, 45.0
LAG = 0.008  # of the drive [s]; a shorter one than this is not believed
KNOWN = Friction(alpha1=0.0)
UNIT = KNOWN.alpha0 * INVERSE_INERTIA / ObserverParameters().bandwidth ** 2


def bristle(level: float, stiffness: float) -> Callable[[np.ndarray], np.ndarray]:
    """Dahl friction [V] of the paper's (5) without damping and Stribeck effect."""

    def force(speeds: np.ndarray) -> np.ndarray:
        z, forces = 0.0, []
        for v in speeds:
            z += DT / SUBSTEPS * (v - stiffness * abs(v) / level * z)
            forces.append(stiffness * z)
        return np.array(forces)

    return force


def sticking(level: float) -> Callable[[np.ndarray], np.ndarray]:
    """Coulomb friction [V]."""
    return lambda speeds: level * np.sign(speeds)


def learn(force: Callable[[np.ndarray], np.ndarray], travel: float, **given: Any) -> Any:
    """What is learned of a joint that swings by ``travel`` [rad] to each side, for 30 s."""
    known = {"friction": KNOWN, "drive": LateDrive(lag=LAG)}
    p = ObserverParameters("recommended")._replace(**(known | given))
    design, memory = design_compensator(p), new_memory(CompensationMemory)[0]
    times = DT / SUBSTEPS * np.arange(30_000 * SUBSTEPS)
    rates = 2.0 * np.pi * np.array([0.7, 1.1])
    speeds = travel * sum(rate * np.sin(rate * times) for rate in rates) / 2.0
    torques = force(speeds) + np.gradient(speeds, times) / INVERSE_INERTIA
    torques += LAG * np.gradient(torques, times)
    means = torques.reshape(-1, SUBSTEPS).mean(axis=1)
    for v, torque in zip(speeds[::SUBSTEPS][1:], means[:-1], strict=True):
        estimate_friction(memory, np.array([0.0, v, 0.0, 0.0, torque]), design)
    return memory["predictive"]["learned"], memory, design


@pytest.mark.parametrize("level", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("stiffness", [0.5, 1.0, 2.0])
def test_a_bristle_is_found(level: float, stiffness: float) -> None:
    """Whatever the parameters say of its level and stiffness."""
    level, stiffness = level * KNOWN.alpha0, stiffness * KNOWN.sigma0
    learned, _, _ = learn(bristle(level, stiffness), 0.05)
    assert learned["level"] * KNOWN.alpha0 == pytest.approx(level, rel=0.05)
    assert learned["presliding"] == pytest.approx(level / stiffness, rel=0.2)


def test_limits() -> None:
    """Of what sticks, and of what is softer than the observer is fast."""
    assert learn(sticking(KNOWN.alpha0), 0.05)[0]["presliding"] == pytest.approx(
        UNIT / FASTEST**2, rel=0.01
    )
    soft = bristle(KNOWN.alpha0, 5.0)
    assert learn(soft, 0.2)[0]["presliding"] == pytest.approx(UNIT / SLOWEST**2, rel=0.01)


def test_stiffness_and_damping_of_the_parameters_only_begin() -> None:
    """With other ones the same is learned; with a rate of 0 those of the parameters are kept."""
    true = bristle(KNOWN.alpha0, KNOWN.sigma0)
    for factor in (0.3, 3.0):
        begun = KNOWN._replace(sigma0=factor * KNOWN.sigma0, sigma1=0.0)
        learned, _, _ = learn(true, 0.05, friction=begun)
        assert learned["presliding"] == pytest.approx(KNOWN.alpha0 / KNOWN.sigma0, rel=0.2)
        kept, _, _ = learn(true, 0.05, friction=begun, learning=LearningParameters(8.0, 0.0))
        assert kept["presliding"] == KNOWN.alpha0 / begun.sigma0


def test_what_is_learned_outlives_a_reset() -> None:
    learned, memory, design = learn(bristle(0.4, 200.0), 0.05)
    before = learned["level"].copy(), learned["presliding"].copy()
    reset(memory)
    estimate_friction(memory, np.zeros(5), design)
    assert (learned["level"], learned["presliding"]) == pytest.approx(before, rel=0.02)
