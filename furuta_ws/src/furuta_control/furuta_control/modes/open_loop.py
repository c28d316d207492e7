"""Mode ``open_loop``: 0 V, to which the excitation signal is added."""

from typing import Any

import numpy as np

from furuta_control.modes.mode import Mode
from furuta_model.compiled import inlined


@inlined
def command(memory: Any, x: np.ndarray, friction: float, p: Any) -> float:
    """0 V."""
    return 0.0


PART = Mode(
    "open_loop",
    "the excitation signal alone, at any pendulum angle, for identification",
    command,
)
