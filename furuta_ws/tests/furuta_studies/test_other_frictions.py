"""Compensation on rigs that differ from the model: told nominal friction, whatever the truth is."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from furuta_analysis.simulation.batch import batch
from furuta_analysis.simulation.closed_loop import Loop, Simulation
from furuta_control.control import ControllerParameters
from furuta_friction.compensation import COMPENSATIONS, ObserverParameters
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum
from furuta_sim.parameters import InitialState, PlantFriction, PlantParameters

ENCODER_COUNT = 2 * pi / 250
NOMINAL = Friction()
# Law and friction of the arm.
TRUTHS = {
    "nominal": ("lugre", NOMINAL),
    "level × 0.7": ("lugre", NOMINAL._replace(alpha0=0.147, alpha1=0.0154)),
    "level × 1.3": ("lugre", NOMINAL._replace(alpha0=0.273, alpha1=0.0286)),
    "soft bristle": ("lugre", NOMINAL._replace(sigma0=40.0)),
    "stiff bristle": ("lugre", NOMINAL._replace(sigma0=1000.0)),
    "stiction 0.2": ("lugre", NOMINAL._replace(alpha1=0.2)),
    "asymmetric": ("lugre", NOMINAL._replace(asymmetry=0.3)),
    "Coulomb": ("coulomb", NOMINAL),
    "Coulomb and stiction": ("stiction", NOMINAL),
    "none": ("lugre", NOMINAL._replace(alpha0=0.0, alpha1=0.0)),
}
# The recommended setting, the same for every rig.
RECOMMENDED = (
    ObserverParameters("combined"),
    ControllerParameters(super_twisting=1.0),
)


def rig(law: str, friction: Friction, seed: int = 0, **plant: object) -> PlantParameters:
    """A plant with this friction."""
    return PlantParameters(
        friction=PlantFriction(law=law, parameters=friction), seed=seed
    )._replace(**plant)


def residuals(loops: list[Loop]) -> np.ndarray:
    """Arm peak to peak [rad] over the second half of 30 s; infinite after a fall."""
    return np.array([np.inf if o.fell else o.phi_peak_to_peak_rad for o in batch(loops, 30.0)])


@pytest.mark.parametrize("name", TRUTHS)
def test_the_recommended_setting_holds_on_any_friction(name: str) -> None:
    """At most one encoder count, and with friction far less than without compensation."""
    plants = [rig(*TRUTHS[name], seed) for seed in range(3)]
    observer, controller = RECOMMENDED
    found = residuals([Loop(p, observer=observer, controller=controller) for p in plants])
    without = residuals([Loop(p) for p in plants])
    assert np.max(found) <= ENCODER_COUNT
    assert np.all(found < (0.01 if name == "none" else 0.1 * without))


@pytest.mark.parametrize("kind", ["disturbance_observer", "combined"])
@pytest.mark.parametrize("name", TRUTHS)
def test_observed_friction_holds_without_super_twisting(name: str, kind: str) -> None:
    """Each alone stays within one encoder count too."""
    loops = [Loop(rig(*TRUTHS[name], k), observer=ObserverParameters(kind)) for k in range(3)]
    assert np.max(residuals(loops)) <= ENCODER_COUNT


def test_the_recommended_setting_holds_a_pendulum_off_the_model() -> None:
    """α, β, δ +10 %, γ −10 %: without compensation 0.7 rad, with the paper's observer a fall."""
    m = FurutaPendulum()
    body = FurutaPendulum(1.1 * m.alpha, 1.1 * m.beta, 0.9 * m.gamma, 1.1 * m.delta)
    plant = rig("lugre", NOMINAL, model=body)
    observer, controller = RECOMMENDED
    loops = [
        Loop(plant),
        Loop(plant, observer=ObserverParameters("lugre")),
        Loop(plant, observer=observer, controller=controller),
    ]
    none, lugre, recommended = residuals(loops)
    assert none == pytest.approx(0.71, abs=0.02)
    assert lugre == np.inf
    assert recommended <= ENCODER_COUNT


@pytest.mark.parametrize("kind", [k for k in COMPENSATIONS if k != "none"])
def test_no_compensation_drives_an_arm_without_friction(kind: str) -> None:
    """The guard ends those that would; the arm then rests as without compensation."""
    plant = rig("lugre", NOMINAL._replace(alpha0=0.0, alpha1=0.0))
    simulation = Simulation(Loop(plant, observer=ObserverParameters(kind)))
    run = simulation.run(30.0)
    assert simulation.switched_off is (kind in ("coulomb", "stiction", "lugre", "adaptive"))
    assert np.ptp(run.state[20_000:, 0]) < 0.01


@pytest.mark.parametrize("phi", [1.0, 3.0, -5.0])
def test_a_far_start_does_not_topple_the_pendulum(phi: float) -> None:
    """The arm returns to its reference."""
    observer, controller = RECOMMENDED
    plant = PlantParameters(initial=InitialState(phi=phi))
    loop = Loop(plant, observer=observer, controller=controller._replace(arm_reference=0.5))
    run = Simulation(loop).run(30.0)
    assert np.max(np.abs(run.state[:, 2])) < 0.5
    assert run.state[-1, 0] == pytest.approx(0.5, abs=0.02)
