"""Friction estimates: always bounded, and exact for an exact model."""

from itertools import product
from math import nan
from typing import Any

import numpy as np
import pytest
import reference

from furuta_friction.compensation import (
    COMPENSATIONS,
    CompensationDesign,
    CompensationMemory,
    ObserverParameters,
    begin,
    beyond_adaptation,
    compensate,
    design_compensator,
    estimate_friction,
)
from furuta_friction.compensators.adaptive import AdaptiveParameters
from furuta_friction.compensators.predictive import LARGEST_ESTIMATE
from furuta_friction.learned_friction import LearningParameters
from furuta_model.block import new_memory
from furuta_model.friction.parameters import Friction

DT = 1e-3


def empty() -> Any:
    """A new memory of the compensation."""
    return new_memory(CompensationMemory)[0]


def signals(v: float, phi: float = 0.0, torque: float = nan) -> np.ndarray:
    """An estimate (5,) with arm speed, arm angle and applied torque."""
    return np.array([phi, v, 0.0, 0.0, torque])


def compensators(**parameters: object) -> dict[str, CompensationDesign]:
    """One compensator of each kind."""
    return {
        kind: design_compensator(ObserverParameters(compensation=kind, **parameters))
        for kind in COMPENSATIONS
    }


def test_none_and_coulomb() -> None:
    """None is 0 V; Coulomb is α₀ sgn(v) with asymmetry and viscous part, 0 at v = 0."""
    lugre = Friction(alpha0=0.2, asymmetry=0.1, viscous=0.5)
    by_kind = compensators(friction=lugre)
    for v, expected in ((2.0, 0.22 + 1.0), (1e-9, 0.22), (0.0, 0.0), (-2.0, -0.18 - 1.0)):
        x = signals(v, phi=0.3)
        assert estimate_friction(empty(), x, by_kind["coulomb"]) == pytest.approx(expected)
        assert estimate_friction(empty(), x, by_kind["none"]) == 0.0


@pytest.mark.parametrize("kind", COMPENSATIONS)
def test_bounded_for_any_motion(kind: str) -> None:
    """No speed, noise, step, K or Γ drives ẑ or F̂ beyond the limits of the parameters."""
    rng = np.random.default_rng(14)
    for dt, gain, asymmetry in product((1e-5, 1e-3, 0.01, 0.1), (-10.0, 0.01, 1e3), (0.0, 0.4)):
        lugre = Friction(viscous=0.1, asymmetry=asymmetry)
        observer = compensators(
            friction=lugre,
            observer_gain=gain,
            adaptive=AdaptiveParameters(abs(gain)),
            sample_time=dt,
        )[kind]
        inverted = 2.0 * observer.predictive.inversion - 1.0
        factor = {"adaptive": 3.0, "recommended": LARGEST_ESTIMATE * inverted}.get(kind, 1.0)
        bound = factor * 0.232 * (1 + asymmetry) * (1 + 1e-9)
        memory, speeds = empty(), rng.choice([-1, 0, 1], 500) * 10 ** rng.uniform(-6, 3, 500)
        unknown, (phi, friction) = rng.random(500) < 0.5, rng.normal(0, 10, (2, 500))
        for x in zip(speeds, phi, np.where(unknown, nan, friction), strict=True):
            v, estimate = x[0], estimate_friction(memory, signals(*x), observer)
            fastest = inverted * np.max(np.abs(speeds)) if kind == "recommended" else abs(v)
            assert abs(estimate) <= bound + lugre.viscous * fastest
            assert abs(lugre.sigma0 * memory["bristle"]["z"]) <= bound
            assert abs(memory["predictive"]["bristle"]) <= 1 + 1e-9


def test_converges_to_the_true_bristle() -> None:
    """Without model error an initial error of ẑ decays, and F̂ is the F of (5)."""
    lugre, dt = Friction(viscous=0.1, asymmetry=0.2), 1e-2
    observer = compensators(friction=lugre, observer_gain=0.0, sample_time=dt)["lugre"]
    memory, z = empty(), 0.0025
    memory["bristle"]["z"] = -0.0025
    for v in 0.6 * np.sin(np.arange(0.01, 3, dt)):
        rate = lugre.sigma0 * abs(v) / reference.level(v, lugre)
        z = v / rate + (z - v / rate) * np.exp(-rate * dt)
        estimate = estimate_friction(memory, signals(v, phi=0.5), observer)
    assert memory["bristle"]["z"] == pytest.approx(z, rel=1e-6)
    force = lugre.sigma0 * z + lugre.sigma1 * (v - rate * z) + lugre.viscous * v
    assert estimate == pytest.approx(force, rel=1e-5)


def test_correction_moves_towards_the_reference() -> None:
    """At v = 0 K moves ẑ by −Kφt, up to the level; while sliding F̂ settles at g(1 − Kφ/v)."""
    lugre = Friction(alpha1=0.0)
    observer = compensators(friction=lugre, observer_gain=0.01, sample_time=DT)["lugre"]
    memory, resting = empty(), signals(0.0, phi=0.2)
    for _ in range(100):
        estimate_friction(memory, resting, observer)
    assert memory["bristle"]["z"] == pytest.approx(-0.01 * 0.2 * 0.1)
    for _ in range(5000):
        estimate = estimate_friction(memory, resting, observer)
    assert memory["bristle"]["z"] == pytest.approx(-0.21 / 80)
    assert estimate == pytest.approx(-0.21)

    sliding = signals(0.1, phi=0.2)
    for _ in range(2000):
        estimate = estimate_friction(memory, sliding, observer)
    assert estimate == pytest.approx(0.21 * (1 - 0.01 * 0.2 / 0.1))


@pytest.mark.parametrize("kind", COMPENSATIONS)
def test_a_switch_begins_as_at_first(kind: str) -> None:
    """After another compensator, or a state that is not known, F̂ is that of a new one."""
    rng = np.random.default_rng(15)
    # No level is learned, as that is kept.
    still = {"learning": LearningParameters(0.0, 0.0), "adaptive": AdaptiveParameters(0.0)}
    by_kind = compensators(**still)
    used, new, begun = empty(), empty(), rng.normal(0, 0.1, (100, 5))
    for x in begun:
        estimate_friction(used, x, by_kind[kind])
    if kind == "none":
        estimate_friction(used, np.full(5, nan), by_kind[kind])
    else:
        estimate_friction(used, begun[0], by_kind["none"])
    for x in begun:
        x[:2] *= 0.5
        assert estimate_friction(used, x, by_kind[kind]) == (
            estimate_friction(new, x, by_kind[kind])
        )


def test_stiction() -> None:
    """Coulomb while sliding; at rest the observed friction, up to breakaway in its direction."""
    lugre = Friction(alpha0=0.2, alpha1=0.1, stribeck_velocity=0.05, asymmetry=0.1, viscous=0.5)
    compensator = compensators(friction=lugre)["stiction"]

    def estimate(v: float, observed: float) -> float:
        return compensate(empty(), signals(v), observed, compensator)

    assert estimate(0.06, -5.0) == pytest.approx(0.2 * 1.1 + 0.5 * 0.06)
    assert estimate(0.04, 0.15) == 0.15
    assert estimate(-0.04, 5.0) == pytest.approx(0.3 * 1.1)
    assert estimate(0.0, -5.0) == pytest.approx(-0.3 * 0.9)
    assert estimate(0.0, nan) == 0.0


def test_adaptation_finds_the_levels_of_both_directions() -> None:
    """From half and twice the level, F̂ converges to the observed friction in each direction."""
    dt = DT
    true = Friction(alpha0=0.3, alpha1=0.03, asymmetry=0.25)
    for level in (0.15, 0.6):
        wrong = Friction(alpha0=level, alpha1=0.1 * level)
        compensator = compensators(friction=wrong, observer_gain=0.0, sample_time=dt)["adaptive"]
        observer = compensators(friction=true, observer_gain=0.0, sample_time=dt)["lugre"]
        memory, true_memory = empty(), empty()
        for v in 0.6 * np.sin(np.arange(0, 20, dt)):
            observed = estimate_friction(true_memory, signals(v), observer)
            compensate(memory, signals(v), observed, compensator)
        learned = memory["adaptive"]
        assert level * (1 + learned["forward"]) == pytest.approx(0.3 * 1.25, rel=0.02)
        assert level * (1 + learned["backward"]) == pytest.approx(0.3 * 0.75, rel=0.02)


def test_adaptation_needs_motion_and_observed_friction() -> None:
    """At rest, or without observed friction, the levels do not change."""
    compensator = compensators()["adaptive"]
    memory = empty()
    for v, observed in ((0.0, 1.0), (0.5, nan)):
        for _ in range(100):
            compensate(memory, signals(v), observed, compensator)
        assert memory["adaptive"].item() == (0.0, 0.0)


@pytest.mark.parametrize(("observed", "expected"), [(0.1, 0.1), (-0.1, -0.1), (5.0, 20 * 0.232)])
def test_the_rest_is_compensated_beside_the_model(observed: float, expected: float) -> None:
    """At rest F̂ is what is observed, limited to twenty levels."""
    compensator, memory, estimate = compensators()["recommended"], empty(), 0.0
    begin(memory, signals(0.0), compensator)
    for _ in range(5000):
        # The drive has been given F̂ alone, so no motion is predicted.
        estimate = compensate(memory, signals(0.0, torque=estimate), observed, compensator)
    assert estimate == pytest.approx(expected, rel=1e-6)


def test_the_level_is_learned_while_the_arm_slides_one_way() -> None:
    """It grows while friction is left, falls more slowly, and holds at rest and while vibrating."""
    compensator = compensators(friction=Friction(alpha1=0.0))["recommended"]

    def level(observed: float, speeds: np.ndarray) -> float:
        memory = empty()
        begin(memory, signals(speeds[0]), compensator)
        for v in speeds:
            compensate(memory, signals(v, torque=0.0), np.sign(v) * observed, compensator)
        return float(memory["predictive"]["learned"]["level"])

    slide, rest = np.full(500, 0.5), np.zeros(500)
    vibration = 0.5 * np.sign(np.sin(2 * np.pi * 25.0 * DT * (np.arange(500) + 0.5)))
    # After 4/k = 80 ms the rate is 8/s × 0.05/0.21.
    grown = 8.0 * 0.05 / 0.21 * 0.42
    assert level(0.05, slide) == pytest.approx(1.0 + grown, rel=0.02)
    assert level(0.05, -slide) == pytest.approx(1.0 + grown, rel=0.02)
    assert level(-0.05, slide) == pytest.approx(1.0 - grown / 4.0, rel=0.02)
    assert level(0.05, rest) == level(0.05, vibration) == 1.0


@pytest.mark.parametrize(("observed", "beyond"), [(0.02, True), (0.25, False)])
def test_adaptation_outside_its_model_is_known(observed: float, beyond: bool) -> None:
    """A friction below a third or above three times the told level."""
    parameters = ObserverParameters("adaptive")
    compensator, memory = design_compensator(parameters), new_memory(CompensationMemory)
    for _ in range(2000):
        compensate(memory[0], signals(0.5), observed, compensator)
    assert beyond_adaptation(memory, parameters) is beyond
    assert not beyond_adaptation(memory, parameters._replace(compensation="lugre"))
