"""Modes ``open_loop`` and ``off``, which do not feed the state back."""

from typing import Any

import numpy as np

from furuta_control.modes.mode import Mode
from furuta_model.compiled import inlined


@inlined
def no_voltage(memory: Any, x: np.ndarray, friction: float, p: Any) -> float:
    """0 V, to which the excitation signal is added."""
    return 0.0


@inlined
def no_drive(memory: Any, x: np.ndarray, friction: float, p: Any) -> float:
    """NaN: the arm is not driven."""
    return np.nan


OPEN_LOOP = Mode(
    "open_loop",
    "the excitation signal alone, at any pendulum angle, for identification",
    no_voltage,
)
OFF = Mode("off", "0 V", no_drive)
