"""Coulomb compensation, eq. (4): the level α₀ in the direction of the estimated speed."""

import numpy as np

from furuta_friction.compensators.bristle_observer import Joint
from furuta_model.compiled import inlined
from furuta_model.friction.levels import direction_factor
from furuta_model.state import PHI_DOT


@inlined
def estimate(x: np.ndarray, p: Joint) -> float:
    """F̂ [V] with asymmetry and viscous part; 0 at v = 0."""
    v = x[PHI_DOT]
    if v == 0.0:
        return 0.0
    level = p.friction.alpha0 * direction_factor(v, p.friction)
    return (level if v > 0.0 else -level) + p.friction.viscous * v
