"""Modes ``open_loop`` and ``off``, which do not feed the state back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from furuta_control.modes.mode import Mode
from furuta_model.compiled import inlined

if TYPE_CHECKING:
    from furuta_control.control import ControllerDesign, ControllerMemory


@inlined
def no_voltage(
    memory: ControllerMemory, x: np.ndarray, friction: float, p: ControllerDesign
) -> float:
    """0 V, to which the excitation signal is added."""
    return 0.0


@inlined
def no_drive(
    memory: ControllerMemory, x: np.ndarray, friction: float, p: ControllerDesign
) -> float:
    """NaN: the arm is not driven."""
    return np.nan


OPEN_LOOP = Mode(
    "open_loop",
    "the excitation signal alone, at any pendulum angle, for identification",
    no_voltage,
)
OFF = Mode("off", "0 V", no_drive)
