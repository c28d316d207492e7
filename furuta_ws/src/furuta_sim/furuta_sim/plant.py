"""Simulates the rig over one sample: drive, motion and sensors.

Plant state and measurement are (5,), see :mod:`furuta_model.state`. The measurement of θ̇ is NaN,
because the rig has no sensor for it.
"""

from __future__ import annotations

from math import floor, nan, pi
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import FrictionLaw, friction_force, friction_law
from furuta_model.integration import advance, substeps_for
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors
from furuta_model.state import BRISTLE, PHI, PHI_DOT, PLANT_STATES, THETA, THETA_DOT
from furuta_sim.parameters import Actuator, PlantParameters

# Random numbers per sample: tachometer, potentiometer.
NOISE_CHANNELS = 2


class Plant(NamedTuple):
    """The simulated rig, as the compiled functions use it."""

    model: FurutaPendulum
    friction: FrictionLaw
    sensors: Sensors
    actuator: Actuator
    sample_time: float
    substeps: int


def design_plant(p: PlantParameters) -> Plant:
    """The rig that the parameters describe, with the number of integration steps it needs."""
    return Plant(
        p.model,
        friction_law(p.friction.law, p.friction.parameters),
        p.sensors,
        p.actuator,
        p.sample_time,
        substeps_for(p.sample_time, p.model, p.friction.parameters),
    )


@compiled
def convert(value: float, full_scale: float, bits: int) -> float:
    """Clip and round ``value`` like a converter of ±``full_scale`` with ``bits``."""
    value = min(max(value, -full_scale), full_scale)
    if bits == 0:
        return value
    half = float(1 << (bits - 1))
    code = floor(value / full_scale * half + 0.5)
    return min(code, half - 1.0) * full_scale / half


@compiled
def drive(command: float, actuator: Actuator) -> float:
    """Torque [V] that the drive applies for a command [V]."""
    return convert(command, actuator.voltage_range, actuator.bits)


@inlined
def measure(x: np.ndarray, noise: np.ndarray, sensors: Sensors, measurement: np.ndarray) -> None:
    """Read the sensors into the first 4 of ``measurement``; ``noise`` (2,) is standard normal."""
    if sensors.ideal:
        for i in range(4):
            measurement[i] = x[i]
        return
    phi = x[PHI]
    if sensors.encoder_counts > 0:
        count = 2.0 * pi / sensors.encoder_counts
        phi = floor(phi / count + 0.5) * count
    measurement[PHI] = phi
    measurement[PHI_DOT] = convert(
        x[PHI_DOT] + sensors.tachometer_noise * noise[0],
        sensors.tachometer_range,
        sensors.tachometer_bits,
    )
    theta = x[THETA] - 2.0 * pi * floor(x[THETA] / (2.0 * pi) + 0.5)
    measurement[THETA] = convert(
        theta + sensors.potentiometer_noise * noise[1],
        sensors.potentiometer_range,
        sensors.potentiometer_bits,
    )
    measurement[THETA_DOT] = nan


@inlined
def move(x: np.ndarray, command: float, plant: Plant) -> float:
    """Move the rig over one sample at constant ``command`` [V]; return the torque applied [V]."""
    torque = drive(command, plant.actuator)
    advance(x, torque, plant.sample_time, plant.substeps, plant.model, plant.friction)
    return torque


@inlined
def true_friction(x: np.ndarray, plant: Plant) -> float:
    """Friction F [V] in plant state ``x`` (5,)."""
    return friction_force(x[PHI_DOT], x[BRISTLE], plant.friction)


def initial_state(plant: PlantParameters) -> np.ndarray:
    """Initial state (5,) with the bristle undeflected."""
    x = np.zeros(PLANT_STATES)
    x[:BRISTLE] = plant.initial
    return x


class Noise:
    """Seeded noise of the sensors. Drawn in blocks; sample k always gets row k."""

    BLOCK = 1024

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng(seed)
        self._rows: list[np.ndarray] = []

    def __call__(self) -> np.ndarray:
        """Noise (2,) of the next sample."""
        if not self._rows:
            self._rows = list(self._generator.standard_normal((self.BLOCK, NOISE_CHANNELS)))[::-1]
        return self._rows.pop()
