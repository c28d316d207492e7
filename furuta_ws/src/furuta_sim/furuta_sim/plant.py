"""Simulates the rig over one sample: drive, motion and sensors.

The measurement is (5,), see :mod:`furuta_model.state`. Parts that the paper's rig lacks stand in
:mod:`furuta_sim.plant_parts`.
"""

from typing import NamedTuple

import numpy as np

from furuta_model.block import new_memory
from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import FrictionLaw, find_law, friction_force, friction_law
from furuta_model.integration import advance, substeps_for
from furuta_model.late_drive import AT_ONCE, acting_torque
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Actuator, Sensors, drive, measure
from furuta_model.state import BRISTLE, PHI, PHI_DOT, SIGNALS
from furuta_ros.wire import Signals
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant_parts import (
    Parts,
    design_parts,
    friction_with_parts,
    move_with_parts,
    read_with_faults,
)

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
    parts: Parts


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
        parts=design_parts(p, friction),
    )


def changed_plant(memory: np.ndarray, before: PlantParameters, p: PlantParameters) -> Plant:
    """The rig with the ``memory`` (1,) whose parameters change between two samples.

    The time of pushes that change counts from now. Friction goes on, but springs start undeflected.
    """
    if p.pushes != before.pushes:
        memory["pushed_from"] = memory["moved"]
    factor = _bristle_stiffness(before) / _bristle_stiffness(p)
    memory["x"][:, BRISTLE] *= factor
    memory["motor"]["bristle"] *= factor
    if find_law(p.friction.law).springs and not find_law(before.friction.law).springs:
        memory["springs"] = memory["motor"]["springs"] = 0.0
    return design_plant(p)


def _bristle_stiffness(p: PlantParameters) -> float:
    """Friction [V] per deflection [rad] that is remembered; 1 if the force itself is."""
    return p.friction.parameters.sigma0 if find_law(p.friction.law).bristle else 1.0


@inlined
def read(memory: PlantMemory, noise: np.ndarray, plant: Plant, measurement: np.ndarray) -> None:
    """Read the sensors, once a sample; see :func:`furuta_model.sensors.measure`."""
    if plant.parts.faults.is_active:
        read_with_faults(memory, noise, plant.sensors, plant.parts.faults, measurement)
    else:
        measure(memory.x, noise, plant.sensors, measurement)
        memory.states_from = memory.readings + 1
    memory.readings += 1


@inlined
def move(memory: PlantMemory, command: float, plant: Plant) -> float:
    """Move the rig over one sample at constant ``command`` [V]; return the drive's voltage [V]."""
    voltage = drive(command, plant.actuator)
    model, law, dt, substeps = plant.model, plant.friction, plant.sample_time, plant.substeps
    if plant.parts.is_active:
        move_with_parts(memory, voltage, dt, substeps, model, law, plant.parts)
    else:
        advance(memory.x, voltage, dt, substeps, model, law)
        # Parts that are switched on continue from here.
        acting_torque(memory.drive, voltage, AT_ONCE)
    if not plant.parts.coupling.on:
        motor, x = memory.motor, memory.x
        motor.angle, motor.speed, motor.bristle = x[PHI], x[PHI_DOT], x[BRISTLE]
    memory.moved += 1
    return voltage


@inlined
def true_friction(memory: PlantMemory, plant: Plant) -> float:
    """Friction F [V] of the arm, and of its motor behind an elastic coupling."""
    if plant.parts.is_active:
        return friction_with_parts(memory, plant.friction, plant.parts)
    return friction_force(memory.x[PHI_DOT], memory.x[BRISTLE], plant.friction)


# For callers in Python: node and emulated rig share the machine code, which takes a quarter of a
# minute to compile. Memory and design are blocks.


@compiled
def read_block(
    memory: np.ndarray, noise: np.ndarray, torque: float, plant: np.ndarray
) -> tuple[Signals, Signals]:
    """The measurement with the applied ``torque`` [V], and the true state and friction."""
    y, x = np.empty(SIGNALS), memory[0].x
    read(memory[0], noise, plant[0], y)
    friction = true_friction(memory[0], plant[0])
    return (y[0], y[1], y[2], y[3], torque), (x[0], x[1], x[2], x[3], friction)


@compiled
def move_block(memory: np.ndarray, command: float, plant: np.ndarray) -> float:
    """Move the plant over one sample; return the drive's voltage [V]."""
    return move(memory[0], command, plant[0])


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
