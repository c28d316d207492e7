"""Compensation on rigs that differ from the model: told nominal friction, whatever the truth is."""

from math import pi

import numpy as np
import pytest

from furuta.lanes.batch import batch
from furuta.settings.settings import load_settings, loop
from furuta_sim.simulation.closed_loop import Simulation

ENCODER_COUNT = 2 * pi / 250
# What is true of the arm.
FRICTIONS = {
    "level × 1.3": "law=lugre alpha0=0.273 alpha1=0.0286",
    "soft bristle": "sigma0=40.0",
    "very stiff bristle": "sigma0=10000.0",
    "stiction of 0.2 V": "alpha1=0.2",
    "asymmetric": "asymmetry=0.3",
    "Coulomb": "law=coulomb",
    "Maxwell slip": "law=maxwell_slip",
    "level varies over the turn": "variation.angle=0.3",
    "none": "alpha0=0.0 alpha1=0.0",
}
# What else is true of the rig.
PARTS = {
    "cogging": "cogging.torque=0.05",
    "dead band": "drive.dead_band=0.1",
    "delay and lag": "drive.delay=5 drive.lag=0.01",
    "noise": "plant.sensors.tachometer_noise=0.0488",
    "missing readings": "sensor_faults.missing=0.05",
    "bias of the speed": "sensor_faults.arm_speed_bias=0.05",
}
# What is true of the coupling of motor and arm.
COUPLINGS = {
    **{f"belt of {f} Hz": f"coupling.frequency={f}" for f in (20, 60, 150)},
    "sensors on the motor": "coupling.frequency=60 coupling.sensors=motor",
    "5 mrad, sensors on the motor": "coupling.frequency=150 coupling.backlash=0.005 "
    "coupling.sensors=motor",
    "friction on both sides": "coupling.frequency=100 coupling.arm_friction=0.5",
}
RECOMMENDED = "compensation=recommended"


def friction(name: str) -> list[str]:
    """Assignments of a row of ``FRICTIONS``."""
    return [f"plant.friction.{each}" for each in FRICTIONS[name].split()]


def residuals(assignments: list[str], *chosen: str, seeds: int = 3) -> np.ndarray:
    """Arm peak to peak [rad] over the second half of 30 s; infinite after a fall.

    What is chosen does not know what is true.
    """
    base = load_settings([], chosen)
    loops = [loop(load_settings([], [*assignments, f"plant.seed={k}"], base)) for k in range(seeds)]
    return np.array([np.inf if o.fell else o.phi_peak_to_peak_rad for o in batch(loops, 30.0)])


@pytest.mark.parametrize("name", FRICTIONS)
def test_it_holds_on_any_friction(name: str) -> None:
    """Half an encoder count at most, and with friction a tenth of what is left without."""
    found = residuals(friction(name), RECOMMENDED)
    without = residuals(friction(name))
    assert np.max(found) <= 0.5 * ENCODER_COUNT
    assert np.all(found < (0.01 if name == "none" else 0.1 * without))


@pytest.mark.parametrize("name", [*PARTS, *COUPLINGS])
def test_it_holds_on_every_rig(name: str) -> None:
    """At most one encoder count, on rigid and elastic arms that it does not know."""
    # A bias of the speed turns the sign of the friction near rest: a count and up to 0.29 of one.
    most = (1.3 if name == "bias of the speed" else 1.0) * ENCODER_COUNT
    assert np.max(residuals((PARTS | COUPLINGS)[name].split(), RECOMMENDED)) <= most


def test_it_does_not_chatter() -> None:
    """Its steps of the command are at most twice those of LuGre compensation."""
    lugre, chosen = (
        next(batch([loop(load_settings([], [f"compensation={name}"]))], 30.0))
        for name in ("lugre", "recommended")
    )
    assert chosen.command_step_v <= 2.0 * lugre.command_step_v


def test_it_holds_a_pendulum_off_the_model() -> None:
    """α, β, δ +10 %, γ −10 %: without compensation 0.7 rad, with the paper's observer a fall."""
    model = {"alpha": 0.031132, "beta": 0.016103, "gamma": 0.0084906, "delta": 0.417241}
    body = [f"plant.model.{name}={value}" for name, value in model.items()]
    assert residuals(body, seeds=1)[0] == pytest.approx(0.71, abs=0.02)
    assert residuals(body, "compensation=lugre", seeds=1)[0] == np.inf
    assert np.max(residuals(body, RECOMMENDED)) <= ENCODER_COUNT


def test_a_far_start_does_not_topple_the_pendulum() -> None:
    """The arm returns to its reference."""
    given = [RECOMMENDED, "phi=-5.0", "arm_reference=0.5"]
    run = Simulation(loop(load_settings([], given))).run(30.0)
    assert np.max(np.abs(run.state[:, 2])) < 0.5
    assert run.state[-1, 0] == pytest.approx(0.5, abs=0.02)


def test_a_truth_without_presliding_defeats_the_observer_with_a_bristle() -> None:
    """Measured on an independent plant: 0.287 rad where the arm truly sticks, Coulomb 0.012."""
    found = residuals(friction("Coulomb"), "compensation=lugre", seeds=1)
    assert found[0] == pytest.approx(0.287, abs=0.02)
    assert residuals(friction("Coulomb"), "compensation=coulomb", seeds=1)[0] < 0.03
