"""Simulates the rig over one sample: drive, motion and sensors.

The measurement is (5,), see :mod:`furuta_model.state`. The measurement of θ̇ is NaN, because the
rig has no sensor for it.
"""

from functools import lru_cache
from math import nan, pi
from typing import NamedTuple

import numpy as np

from furuta_model.block import new_memory
from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import (
    FrictionLaw,
    find_law,
    friction_force,
    friction_law,
)
from furuta_model.integration import advance, substeps_for
from furuta_model.parts.converter import Actuator, convert, drive
from furuta_model.parts.coupling import ElasticRig, design_coupling
from furuta_model.parts.drive import Drive, mean_torque
from furuta_model.parts.elastic_motion import advance_elastic, motor_friction
from furuta_model.parts.friction_variation import FrictionVariation, vary_level
from furuta_model.parts.motion import (
    Body,
    Cogging,
    PendulumFriction,
    advance_with_parts,
    varied_friction,
)
from furuta_model.parts.plant_memory import PlantMemory
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
    coupling: ElasticRig
    faults: FaultySensors


def design_plant(p: PlantParameters) -> Plant:
    """The rig that the parameters describe, with the number of integration steps it needs."""
    friction = friction_law(p.friction.law, p.friction.parameters)
    return Plant(
        model=p.model,
        friction=friction,
        sensors=p.sensors,
        actuator=p.actuator,
        sample_time=p.sample_time,
        substeps=substeps_for(p.sample_time, p.model, p.friction.parameters),
        parts=_design_parts(
            law=p.friction.law,
            springs=p.friction.springs,
            variation=p.friction.variation,
            drive=p.drive,
            cogging=p.cogging,
            pendulum_friction=p.pendulum_friction,
            tilt=p.tilt,
            pushes=p.pushes,
            waves=p.waves,
            elastic=p.coupling.is_elastic,
            sample_time=p.sample_time,
        ),
        coupling=design_coupling(p.coupling, p.model, friction, p.sample_time),
        faults=design_faults(p.sensor_faults, p.coupling.senses_motor, p.sample_time, p.seed),
    )


@lru_cache(maxsize=256)
def _design_parts(
    law: str,
    springs: int,
    variation: FrictionVariation,
    drive: Drive,
    cogging: Cogging,
    pendulum_friction: PendulumFriction,
    tilt: Tilt,
    pushes: Pushes,
    waves: TorqueWaves,
    elastic: bool,
    sample_time: float,
) -> Parts:
    """The parts, which the rigs of a study mostly have in common."""
    table = waves.table
    on = any(part != type(part)() for part in (variation, drive, cogging, pendulum_friction, tilt))
    return Parts(
        any=on or elastic or find_law(law).springs or pushes.number > 0 or len(table) > 0,
        springs=springs,
        variation=variation,
        drive=drive,
        cogging=cogging,
        pendulum_friction=pendulum_friction,
        tilt=tilt,
        push_count=pushes.number,
        pushes=pushes.profile(sample_time),
        waves=table,
    )


@inlined
def read(memory: PlantMemory, noise: np.ndarray, plant: Plant, measurement: np.ndarray) -> None:
    """Read the sensors with their faults, once a sample; see :func:`measure`."""
    if plant.faults.any:
        _read_with_faults(memory, noise, plant.sensors, plant.faults, measurement)
    else:
        measure(memory.x, noise, plant.sensors, measurement)


@compiled
def _read_with_faults(
    memory: PlantMemory,
    noise: np.ndarray,
    sensors: Sensors,
    faults: FaultySensors,
    measurement: np.ndarray,
) -> None:
    phi, v = faulty_state(memory, PHI, faults), faulty_state(memory, PHI_DOT, faults)
    theta, w = faulty_state(memory, THETA, faults), faulty_state(memory, THETA_DOT, faults)
    _measure(phi, v, theta, w, noise, sensors, measurement)
    apply_faults(memory, measurement, faults)


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
def move(memory: PlantMemory, command: float, plant: Plant) -> float:
    """Move the rig over one sample at constant ``command`` [V]; return the drive's voltage [V]."""
    voltage = drive(command, plant.actuator)
    if plant.parts.any:
        _move_with_parts(memory, voltage, plant)
    else:
        dt = plant.sample_time
        advance(memory.x, voltage, dt, plant.substeps, plant.model, plant.friction)
    return voltage


@compiled
def _move_with_parts(memory: PlantMemory, voltage: float, plant: Plant) -> None:
    parts, dt = plant.parts, plant.sample_time
    friction = true_friction(memory, plant)
    torque = mean_torque(memory, voltage, dt, parts.drive)
    vary_level(memory, torque, friction, memory.x[PHI_DOT], dt, parts.variation)
    sample = memory.moved - memory.pushed_from
    push = with_tilt(push_at(sample, parts.pushes, parts.push_count), parts.tilt)
    body = Body(
        model=plant.model,
        variation=parts.variation,
        cogging=parts.cogging,
        pendulum_friction=parts.pendulum_friction,
        springs=parts.springs,
        push=push,
        waves=parts.waves,
        memory=memory,
    )
    if plant.coupling.on:
        advance_elastic(memory.x, torque, dt, body, plant.coupling)
    else:
        advance_with_parts(memory.x, torque, dt, plant.substeps, body, plant.friction)
    memory.moved += 1


@inlined
def true_friction(memory: PlantMemory, plant: Plant) -> float:
    """Friction F [V] of the arm, and of its motor behind an elastic coupling."""
    if plant.parts.any:
        return _friction_with_parts(memory, plant)
    return friction_force(memory.x[PHI_DOT], memory.x[BRISTLE], plant.friction)


@compiled
def _friction_with_parts(memory: PlantMemory, plant: Plant) -> float:
    coupling, springs, variation = plant.coupling, plant.parts.springs, plant.parts.variation
    if not coupling.on:
        return varied_friction(memory, plant.friction, springs, variation)
    arm = varied_friction(memory, coupling.arm_friction, springs, variation)
    return arm + motor_friction(memory, springs, variation, coupling)


def initial_plant(plant: PlantParameters) -> np.ndarray:
    """Memory (1,) of a plant in its initial state, with the bristle undeflected."""
    memory = new_memory(PlantMemory)
    memory["x"][0, :BRISTLE] = plant.initial
    memory["motor"]["angle"], memory["motor"]["speed"] = plant.initial.phi, plant.initial.phi_dot
    return memory


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
