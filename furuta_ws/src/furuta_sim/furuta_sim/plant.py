"""The rig's converters and one sample of the whole rig: command in, state moved, sensors read.

The state is (5,): x = (φ, φ̇, θ, θ̇) and the bristle deflection z. A measurement is (5,): the order
of x, with NaN where the rig has no sensor (θ̇), and the torque applied since the last one [V].
"""

from __future__ import annotations

from math import floor, nan, pi

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.integration import advance, substeps_for
from furuta_model.sensors import Sensors
from furuta_model.state import BRISTLE, PHI, PHI_DOT, PLANT_STATES, THETA, THETA_DOT
from furuta_sim.parameters import Actuator, PlantParameters

# Noise drawn per sample: tachometer, potentiometer.
NOISE_CHANNELS = 2


@compiled
def convert(value: float, full_scale: float, bits: int) -> float:
    """What a converter of ±``full_scale`` and ``bits`` makes of ``value``: clipped, rounded."""
    value = min(max(value, -full_scale), full_scale)
    if bits == 0:
        return value
    half = float(1 << (bits - 1))
    code = floor(value / full_scale * half + 0.5)
    return min(code, half - 1.0) * full_scale / half


@compiled
def drive(command: float, actuator: Actuator) -> float:
    """Torque [V] that the drive makes of a command [V]."""
    return convert(command, actuator.voltage_range, actuator.bits)


@compiled
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


@compiled
def move(x: np.ndarray, command: float, substeps: int, plant: PlantParameters) -> float:
    """Move the rig over one sample with ``command`` [V] held; the torque applied [V]."""
    torque = drive(command, plant.actuator)
    advance(x, torque, plant.sample_time, substeps, plant.model, plant.friction)
    return torque


def substeps(plant: PlantParameters) -> int:
    """Integration steps per sample that this plant needs."""
    return substeps_for(plant.sample_time, plant.model, plant.friction)


def initial_state(plant: PlantParameters) -> np.ndarray:
    """State (5,) at rest of the bristle."""
    x = np.zeros(PLANT_STATES)
    x[:BRISTLE] = plant.initial
    return x


class Noise:
    """The sensors' noise as one seeded stream, drawn in blocks: sample k always gets row k."""

    BLOCK = 1024

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng(seed)
        self._rows: list[np.ndarray] = []

    def __call__(self) -> np.ndarray:
        """The next sample's noise (2,)."""
        if not self._rows:
            self._rows = list(self._generator.standard_normal((self.BLOCK, NOISE_CHANNELS)))[::-1]
        return self._rows.pop()
