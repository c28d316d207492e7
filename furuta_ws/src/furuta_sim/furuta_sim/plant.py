"""Simulates the rig over one sample: drive, motion and sensors.

The measurement is (5,), see :mod:`furuta_model.state`. The measurement of θ̇ is NaN, because the
rig has no sensor for it. The array x begins with the plant state (5,); the rest is memory of the
parts that are on (:mod:`furuta_model.parts.plant_memory`). A rig without them needs only the state.
"""

from __future__ import annotations

from functools import lru_cache
from math import nan, pi
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import (
    HAS_SPRINGS,
    LAWS,
    FrictionLaw,
    friction_force,
    friction_law,
)
from furuta_model.integration import advance, substeps_for
from furuta_model.parts.converter import Actuator, convert, drive
from furuta_model.parts.drive import Drive, mean_torque
from furuta_model.parts.friction_variation import FrictionVariation, vary_level
from furuta_model.parts.motion import (
    Body,
    Cogging,
    PendulumFriction,
    advance_with_parts,
    varied_friction,
)
from furuta_model.parts.plant_memory import MOVED, PLANT_MEMORY
from furuta_model.parts.pushes import Pushes, push_at
from furuta_model.parts.sensor_faults import (
    FaultySensors,
    apply_faults,
    design_faults,
    faulty_state,
)
from furuta_model.parts.tilt import Tilt, with_tilt
from furuta_model.parts.torque_waves import TorqueWaves
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors
from furuta_model.state import BRISTLE, PHI, PHI_DOT, THETA, THETA_DOT
from furuta_sim.parameters import PlantParameters

# Random numbers per sample: tachometer, potentiometer.
NOISE_CHANNELS = 2
# Turns per radian.
PER_TURN = 1.0 / (2.0 * pi)


class Parts(NamedTuple):
    """Parts of the rig that act on its motion; ``any`` says whether one of them is on."""

    any: bool
    springs: int
    variation: FrictionVariation
    drive: Drive
    cogging: Cogging
    pendulum_friction: PendulumFriction
    tilt: Tilt
    push_count: int
    pushes: np.ndarray
    waves: np.ndarray


class Plant(NamedTuple):
    """The simulated rig, as the compiled functions use it."""

    model: FurutaPendulum
    friction: FrictionLaw
    sensors: Sensors
    actuator: Actuator
    sample_time: float
    substeps: int
    parts: Parts
    faults: FaultySensors


def design_plant(p: PlantParameters) -> Plant:
    """The rig that the parameters describe, with the number of integration steps it needs."""
    return Plant(
        p.model,
        friction_law(p.friction.law, p.friction.parameters),
        p.sensors,
        p.actuator,
        p.sample_time,
        substeps_for(p.sample_time, p.model, p.friction.parameters),
        _design_parts(p),
        design_faults(p.sensor_faults, p.sample_time, p.seed),
    )


def _design_parts(p: PlantParameters) -> Parts:
    given = (p.friction.variation, p.drive, p.cogging, p.pendulum_friction, p.tilt)
    has_springs = HAS_SPRINGS[LAWS.index(p.friction.law)]
    return _parts(p.friction.springs, has_springs, given, p.pushes, p.waves, p.sample_time)


@lru_cache(maxsize=256)
def _parts(
    springs: int,
    has_springs: bool,
    given: tuple[FrictionVariation, Drive, Cogging, PendulumFriction, Tilt],
    pushes: Pushes,
    waves: TorqueWaves,
    sample_time: float,
) -> Parts:
    """The parts, which the rigs of a study mostly have in common."""
    table = waves.table
    some = has_springs or pushes.number > 0 or len(table) > 0
    return Parts(
        some or any(each != type(each)() for each in given),
        springs,
        *given,
        pushes.number,
        pushes.profile(sample_time),
        table,
    )


@inlined
def read(x: np.ndarray, noise: np.ndarray, plant: Plant, measurement: np.ndarray) -> None:
    """Read the sensors with their faults, once a sample; see :func:`measure`."""
    if plant.faults.any:
        _read_with_faults(x, noise, plant.sensors, plant.faults, measurement)
    else:
        measure(x, noise, plant.sensors, measurement)


@compiled
def _read_with_faults(
    x: np.ndarray,
    noise: np.ndarray,
    sensors: Sensors,
    faults: FaultySensors,
    measurement: np.ndarray,
) -> None:
    phi, v = faulty_state(x, PHI, faults), faulty_state(x, PHI_DOT, faults)
    theta, w = faulty_state(x, THETA, faults), faulty_state(x, THETA_DOT, faults)
    _measure(phi, v, theta, w, noise, sensors, measurement)
    apply_faults(x, measurement, faults)


@inlined
def measure(x: np.ndarray, noise: np.ndarray, sensors: Sensors, measurement: np.ndarray) -> None:
    """Read sound sensors into the first 4 of ``measurement``; ``noise`` (2,) is standard normal."""
    _measure(x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT], noise, sensors, measurement)


@inlined
def _measure(
    phi: float,
    v: float,
    theta: float,
    w: float,
    noise: np.ndarray,
    sensors: Sensors,
    measurement: np.ndarray,
) -> None:
    if sensors.ideal:
        measurement[PHI], measurement[PHI_DOT] = phi, v
        measurement[THETA], measurement[THETA_DOT] = theta, w
        return
    if sensors.encoder_counts > 0:
        count = 2.0 * pi / sensors.encoder_counts
        phi = np.floor(phi * (sensors.encoder_counts * PER_TURN) + 0.5) * count
    measurement[PHI] = phi
    measurement[PHI_DOT] = convert(
        v + sensors.tachometer_noise * noise[0],
        sensors.tachometer_range,
        sensors.tachometer_bits,
    )
    theta -= 2.0 * pi * np.floor(theta * PER_TURN + 0.5)
    measurement[THETA] = convert(
        theta + sensors.potentiometer_noise * noise[1],
        sensors.potentiometer_range,
        sensors.potentiometer_bits,
    )
    measurement[THETA_DOT] = nan


@inlined
def move(x: np.ndarray, command: float, plant: Plant) -> float:
    """Move the rig over one sample at constant ``command`` [V]; return the drive's voltage [V]."""
    voltage = drive(command, plant.actuator)
    if plant.parts.any:
        _move_with_parts(x, voltage, plant)
    else:
        advance(x, voltage, plant.sample_time, plant.substeps, plant.model, plant.friction)
    return voltage


@compiled
def _move_with_parts(x: np.ndarray, voltage: float, plant: Plant) -> None:
    parts, dt = plant.parts, plant.sample_time
    friction = true_friction(x, plant)
    torque = mean_torque(x, voltage, dt, parts.drive)
    vary_level(x, torque, friction, x[PHI_DOT], dt, parts.variation)
    push = with_tilt(push_at(x[MOVED], parts.pushes, parts.push_count), parts.tilt)
    body = Body(
        plant.model,
        parts.variation,
        parts.cogging,
        parts.pendulum_friction,
        parts.springs,
        push,
        parts.waves,
        x,
    )
    advance_with_parts(x, torque, dt, plant.substeps, body, plant.friction)
    x[MOVED] += 1.0


@inlined
def true_friction(x: np.ndarray, plant: Plant) -> float:
    """Friction F [V] of the arm in state ``x``."""
    if plant.parts.any:
        return varied_friction(x, plant.friction, plant.parts.springs, plant.parts.variation)
    return friction_force(x[PHI_DOT], x[BRISTLE], plant.friction)


def initial_state(plant: PlantParameters) -> np.ndarray:
    """Initial state, with the bristle undeflected, and empty memory of the parts."""
    x = np.zeros(PLANT_MEMORY)
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
