"""The parts of a real rig that the plain plant lacks, all off by default.

They act on drive, motion and friction, or on the sensors. The plain plant needs none of them
(:mod:`furuta_sim.plant`).
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import FrictionLaw, find_law
from furuta_model.late_drive import SampledDrive, acting_torque, design_drive, without_dead_band
from furuta_model.parts.coupling import (
    ElasticRig,
    advance_elastic,
    design_coupling,
)
from furuta_model.parts.disturbances import Pushes, Tilt, TorqueWaves, push_at
from furuta_model.parts.motion import Body, Cogging, PendulumFriction, advance_with_parts
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.parts.sensor_faults import (
    FaultySensors,
    apply_faults,
    design_faults,
    faulty_state,
)
from furuta_model.parts.varied_friction import (
    FrictionVariation,
    joint_friction,
    varied,
)
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors, measure
from furuta_model.state import BRISTLE, PHI, PHI_DOT, RIGID_STATES
from furuta_sim.parameters import PlantParameters


class Parts(NamedTuple):
    """The parts; ``is_active`` says whether one of them acts on drive, motion or friction."""

    is_active: bool
    springs: int
    variation: FrictionVariation
    dead_band: float
    drive: SampledDrive
    cogging: Cogging
    pendulum_friction: PendulumFriction
    tilt: Tilt
    push_count: int
    pushes: np.ndarray
    waves: np.ndarray
    coupling: ElasticRig
    faults: FaultySensors


def design_parts(p: PlantParameters, law: FrictionLaw) -> Parts:
    """The parts of a rig whose arm has the friction ``law``."""
    variation, elastic = p.friction.variation, p.coupling.is_elastic
    pushes, waves = _tables(p.pushes, p.waves, p.sample_time)
    optional = (variation, p.drive, p.cogging, p.pendulum_friction, p.tilt)
    faults = p.sensor_faults
    if p.sensors.ideal:
        faults = faults._replace(speed_bandwidth=0.0)
    changed = any(part != type(part)() for part in optional)
    pushed = p.pushes.number > 0 or len(waves) > 0
    return Parts(
        is_active=elastic or changed or pushed or find_law(p.friction.law).springs,
        springs=p.friction.springs,
        variation=variation,
        dead_band=p.drive.dead_band,
        drive=design_drive(p.drive.late, p.sample_time),
        cogging=p.cogging,
        pendulum_friction=p.pendulum_friction,
        tilt=p.tilt,
        push_count=p.pushes.number,
        pushes=pushes,
        waves=waves,
        coupling=design_coupling(p.coupling, p.model, law, p.sample_time),
        faults=design_faults(faults, p.coupling.senses_motor, p.sample_time, p.seed),
    )


@lru_cache(maxsize=256)
def _tables(
    pushes: Pushes, waves: TorqueWaves, sample_time: float
) -> tuple[np.ndarray, np.ndarray]:
    """Pushes and waves as arrays, which the rigs of a study mostly have in common."""
    return pushes.profile(sample_time), waves.table


@compiled
def read_with_faults(
    memory: PlantMemory,
    noise: np.ndarray,
    sensors: Sensors,
    faults: FaultySensors,
    measurement: np.ndarray,
) -> None:
    """Read faulty sensors; see :func:`furuta_sim.plant.read`."""
    for i in range(RIGID_STATES):
        measurement[i] = faulty_state(memory, i, faults)
    measure(measurement, noise, sensors, measurement)
    apply_faults(memory, measurement, faults)


@compiled
def move_with_parts(
    memory: PlantMemory,
    voltage: float,
    dt: float,
    substeps: int,
    model: FurutaPendulum,
    law: FrictionLaw,
    parts: Parts,
) -> None:
    """Move the rig over ``dt`` [s] at constant ``voltage`` [V] of the drive."""
    given = without_dead_band(voltage, parts.dead_band)
    torque = acting_torque(memory.drive, given, parts.drive)
    sample = memory.moved - memory.pushed_from
    push = push_at(sample, parts.pushes, parts.push_count, parts.tilt)
    body = Body(
        model=model,
        variation=parts.variation,
        cogging=parts.cogging,
        pendulum_friction=parts.pendulum_friction,
        springs=parts.springs,
        push=push,
        waves=parts.waves,
        memory=memory,
    )
    if parts.coupling.on:
        advance_elastic(memory.x, torque, dt, body, parts.coupling)
    else:
        advance_with_parts(memory.x, torque, dt, substeps, body, law)


@compiled
def friction_with_parts(memory: PlantMemory, law: FrictionLaw, parts: Parts) -> float:
    """Friction F [V] of the arm, and of its motor behind an elastic coupling."""
    motor, coupling = memory.motor, parts.coupling
    if not coupling.on:
        return _arm_friction(memory, law, parts)
    law = varied(coupling.motor_friction, motor.angle, parts.variation)
    of_motor = joint_friction(motor, motor.speed, motor.bristle, parts.springs, law)
    return _arm_friction(memory, coupling.arm_friction, parts) + of_motor


@inlined
def _arm_friction(memory: PlantMemory, law: FrictionLaw, parts: Parts) -> float:
    x = memory.x
    law = varied(law, x[PHI], parts.variation)
    return joint_friction(memory, x[PHI_DOT], x[BRISTLE], parts.springs, law)
