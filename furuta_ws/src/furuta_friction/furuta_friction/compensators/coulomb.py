"""Coulomb compensation, eq. (4): the level α₀ in the direction of the estimated speed."""

from typing import Any

import numpy as np

from furuta_friction.compensator import Compensator
from furuta_model.compiled import inlined
from furuta_model.friction.laws import LAWS, FrictionLaw, steady_friction
from furuta_model.state import PHI_DOT

_COULOMB = LAWS.index("coulomb")


@inlined
def estimate(memory: Any, x: np.ndarray, p: Any) -> float:
    """F̂ [V] with asymmetry and viscous part; 0 at v = 0."""
    return steady_friction(x[PHI_DOT], FrictionLaw(_COULOMB, p.friction, 0, 0))


PART = Compensator("coulomb", "eq. (4) with level alpha0", estimate)
