"""No compensation."""

from typing import Any

import numpy as np

from furuta_friction.compensator import Compensator
from furuta_model.compiled import inlined


@inlined
def estimate(memory: Any, x: np.ndarray, p: Any) -> float:
    """0 V."""
    return 0.0


PART = Compensator("none", "0 V", estimate)
