"""No compensation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from furuta_friction.compensator import Compensator
from furuta_model.compiled import inlined

if TYPE_CHECKING:
    from furuta_friction.compensation import CompensationDesign, CompensationMemory


@inlined
def estimate(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> float:
    """0 V."""
    return 0.0


COMPENSATOR = Compensator("none", "0 V", estimate)
