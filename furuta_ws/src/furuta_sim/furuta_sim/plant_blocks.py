"""The sample of a plant for callers in Python: its design and its memory are blocks.

Node and emulated rig share the machine code, which takes a quarter of a minute to compile.
"""

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.state import SIGNALS
from furuta_sim.plant import move, read, true_friction

Signals = tuple[float, float, float, float, float]


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
