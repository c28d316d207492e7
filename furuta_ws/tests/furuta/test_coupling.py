"""Motor and arm with an elastic coupling: against an independent integration, and its limits."""

from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np
import pytest
from plant_steps import PlantSteps
from scipy.integrate import solve_ivp

from furuta.outcomes import outcome
from furuta.settings.settings import load_settings, loop, rig_settings
from furuta_hw.emulator.emulated_rig import EmulatedRig, plant_of
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import build
from furuta_model.parts.coupling import Coupling
from furuta_sim.parameters import PlantParameters

SAMPLES = 150
START = np.array([0.1, 0.3, 0.1, -0.2])


def rig(**given: Any) -> PlantParameters:
    """A rig with a coupling; ideal drive."""
    values = {f"coupling.{name}": value for name, value in given.items()}
    return build(PlantParameters, values | {"actuator.bits": 0})


def moved(parameters: PlantParameters, commands: np.ndarray, twist: float) -> np.ndarray:
    """φ, φ̇, θ, θ̇, ψ, ψ̇ after every sample (n, 6)."""
    plant, rows = PlantSteps(parameters), []
    memory = plant.memory
    memory["x"][0, :4] = START
    memory["motor"]["angle"], memory["motor"]["speed"] = START[0] + twist, START[1]
    for u in commands:
        plant.move(u)
        motor = memory["motor"][0]
        rows.append([*memory["x"][0, :4], motor["angle"], motor["speed"]])
    return np.array(rows)


def two_masses(p: PlantParameters, u: float) -> Callable[[float, np.ndarray], list[float]]:
    """The equations from the Lagrangian of two masses, with LuGre friction on both."""
    body, c, f = p.model, p.coupling, p.friction.parameters
    whole = body.alpha - body.gamma**2 / body.beta
    motor = c.motor_inertia * whole
    mass = motor * (whole - motor) / whole
    omega, gap = 2 * pi * c.frequency, c.backlash / 2

    def bristle(v: float, z: float) -> tuple[float, float]:
        level = f.alpha0 + f.alpha1 * np.exp(-((v / f.stribeck_velocity) ** 2))
        rate = v - f.sigma0 * abs(v) * z / level
        return rate, f.sigma0 * z + f.sigma1 * rate

    def rate(_: float, y: np.ndarray) -> list[float]:
        phi, v, theta, w, psi, speed, z_arm, z_motor = y
        twist, slip = psi - phi, speed - v
        stretched = twist - np.clip(twist, -gap, gap)
        torque = mass * (omega**2 * stretched + 2 * c.damping * omega * slip)
        if gap > 0.0 and torque * stretched <= 0.0:
            torque = 0.0
        arm_rate, arm = bristle(v, z_arm)
        motor_rate, at_motor = bristle(speed, z_motor)
        s, k = np.sin(theta), np.cos(theta)
        inertia = [
            [body.alpha - motor + body.beta * s**2, body.gamma * k],
            [body.gamma * k, body.beta],
        ]
        forces = [
            torque - c.arm_friction * arm - 2 * body.beta * k * s * v * w + body.gamma * s * w**2,
            body.beta * k * s * v**2 + body.delta * s,
        ]
        v_dot, w_dot = np.linalg.solve(inertia, forces)
        driven = u - torque - (1 - c.arm_friction) * at_motor
        return [v, v_dot, w, w_dot, speed, driven / motor, arm_rate, motor_rate]

    return rate


def edges(gap: float) -> list[Any]:
    """Events of scipy at which the gap opens or closes: the torque jumps there."""

    def upper(_: float, y: np.ndarray) -> float:
        return float(y[4] - y[0] - gap)

    def lower(_: float, y: np.ndarray) -> float:
        return float(y[4] - y[0] + gap)

    for event in (upper, lower):
        event.terminal = True  # type: ignore[attr-defined]
    return [upper, lower]


def expected(p: PlantParameters, commands: np.ndarray, twist: float) -> np.ndarray:
    """The same by scipy, which starts again at each event."""
    y = np.array([*START, START[0] + twist, START[1], 0.0, 0.0])
    events = edges(p.coupling.backlash / 2) if p.coupling.backlash > 0.0 else []
    rows = []
    for u in commands:
        rate, t, end = two_masses(p, float(u)), 0.0, p.sample_time
        while t < end:
            run = solve_ivp(rate, (t, end), y, "DOP853", events=events, rtol=1e-9, atol=1e-12)
            t, y = run.t[-1], run.y[:, -1]
            if t < end:  # step over the edge
                y = y + 1e-9 * np.array(rate(t, y))
                t += 1e-9
        rows.append(y[:6])
    return np.array(rows)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(("backlash", "error"), [(0.0, 1e-6), (0.03, 1e-4)])
def test_motion_is_that_of_two_masses(seed: int, backlash: float, error: float) -> None:
    """With random parameters: all angles within 1e-6 rad, with backlash and impacts 1e-4 rad."""
    r = np.random.default_rng(seed)
    given = rig(
        frequency=r.uniform(20.0, 150.0),
        damping=r.uniform(0.01, 0.1),
        motor_inertia=r.uniform(0.2, 0.8),
        arm_friction=r.uniform(0.0, 1.0),
        backlash=r.uniform(0.1, 1.0) * backlash,
    )
    commands = 0.5 * np.sin(np.arange(SAMPLES) * 0.03) + 0.1 * r.standard_normal(SAMPLES)
    twist = r.uniform(-5e-4, 5e-4)
    difference = moved(given, commands, twist) - expected(given, commands, twist)
    assert np.abs(difference[:, [0, 2, 4]]).max() < error


@pytest.mark.parametrize("law", ["coulomb", "maxwell_slip"])
def test_a_stiff_coupling_is_a_rigid_one(law: str) -> None:
    """At 500 Hz the residual is that of one mass, wherever the friction acts."""
    sizes = []
    for coupling in ("0.0", "500.0", "500.0 coupling.arm_friction=0.5"):
        given = f"friction.law={law} sensors.ideal=true coupling.frequency={coupling}".split()
        sizes.append(outcome(loop(load_settings([], given)), 10.0).phi_peak_to_peak_rad)
    assert sizes[1:] == pytest.approx([sizes[0]] * 2, rel=0.01)


def test_rig_file_and_emulated_rig_have_the_coupling() -> None:
    """The simulation of a rig has it, and an emulated encoder on the motor sees the motor."""
    belt = Coupling(frequency=50.0, sensors="motor")
    described = Rig(coupling=belt)
    assert loop(rig_settings(described)).plant.coupling == belt
    emulated = EmulatedRig(described, plant_of(described))
    emulated._memory["motor"]["angle"] = 1.0
    arm, _, _ = emulated._codes()
    assert arm == round(250 / (2 * pi))
