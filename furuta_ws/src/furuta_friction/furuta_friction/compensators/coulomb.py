"""Coulomb compensation, eq. (4): the level α₀ in the direction of the estimated speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from furuta_friction.compensator import Compensator
from furuta_model.compiled import inlined
from furuta_model.friction.laws import LAWS, FrictionLaw, steady_friction
from furuta_model.state import PHI_DOT

if TYPE_CHECKING:
    from furuta_friction.compensation import CompensationDesign, CompensationMemory

_COULOMB = LAWS.index("coulomb")


@inlined
def estimate(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> float:
    """F̂ [V] with asymmetry and viscous part; 0 at v = 0."""
    return steady_friction(x[PHI_DOT], FrictionLaw(_COULOMB, p.friction))


COMPENSATOR = Compensator("coulomb", "eq. (4) with level alpha0", estimate)
