"""Mode ``off``: the arm is not driven."""

from typing import Any

import numpy as np

from furuta_control.modes.mode import Mode
from furuta_model.compiled import inlined


@inlined
def command(memory: Any, x: np.ndarray, friction: float, p: Any) -> float:
    """NaN."""
    return np.nan


PART = Mode("off", "0 V", command)
