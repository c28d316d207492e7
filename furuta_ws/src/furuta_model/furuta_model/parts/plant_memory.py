"""What the plant remembers from sample to sample."""

from dataclasses import dataclass, field

import numpy as np

from furuta_model.block import zeros
from furuta_model.friction.maxwell_slip import MAX_SPRINGS
from furuta_model.late_drive import DELAY_SLOTS, DriveMemory
from furuta_model.state import PLANT_STATES, RIGID_STATES


@dataclass
class MotorMemory:
    """The motor behind an elastic coupling: angle [rad], speed [rad/s] and its friction.

    ``bristle`` and the springs are those of :class:`PlantMemory` and its state, on the motor.
    """

    angle: float = 0.0
    speed: float = 0.0
    bristle: float = 0.0
    springs: np.ndarray = zeros(MAX_SPRINGS)
    next_springs: np.ndarray = zeros(MAX_SPRINGS)


@dataclass
class PlantMemory:
    """The plant state, and what the parts of the rig remember, zero if no part needs it.

    Attributes:
        x: Plant state (5,), see :mod:`furuta_model.state`.
        springs: Deflections of the springs of the Maxwell-slip law [rad].
        next_springs: The same at the end of the substep.
        moved: Samples that the plant has moved.
        pushed_from: The sample from which the time of the pushes counts.
        readings: Readings taken.
        states_from: The first reading of ``states``, the next one without faults.
        drive: What the drive has been given, and the torque behind its lag [V].
        last_reading: Last reading of each signal, which a stuck sensor repeats.
        states: The last states, for the delay of the sensors.
        motor: The motor; it follows the arm unless its coupling is elastic.
    """

    x: np.ndarray = zeros(PLANT_STATES)
    springs: np.ndarray = zeros(MAX_SPRINGS)
    next_springs: np.ndarray = zeros(MAX_SPRINGS)
    moved: int = 0
    pushed_from: int = 0
    readings: int = 0
    states_from: int = 0
    drive: DriveMemory = field(default_factory=DriveMemory)
    last_reading: np.ndarray = zeros(RIGID_STATES)
    states: np.ndarray = zeros(DELAY_SLOTS, RIGID_STATES)
    motor: MotorMemory = field(default_factory=MotorMemory)
