"""Stiction compensation: Coulomb friction while the arm slides, the observed friction at rest.

The arm counts as at rest below the Stribeck velocity. The estimate is limited to the breakaway
level α₀ + α₁.
"""

from math import isnan

import numpy as np

from furuta_friction.compensators import coulomb
from furuta_friction.compensators.bristle_observer import Joint
from furuta_model.compiled import inlined
from furuta_model.friction.levels import direction_factor, static_level
from furuta_model.state import PHI_DOT


@inlined
def estimate(x: np.ndarray, observed: float, p: Joint) -> float:
    """F̂ [V] for the ``observed`` friction [V]; 0 at rest if that is NaN."""
    if abs(x[PHI_DOT]) > p.friction.stribeck_velocity:
        return coulomb.estimate(x, p)
    if isnan(observed):
        return 0.0
    level = static_level(p.friction)
    backward, forward = (
        level * direction_factor(-1.0, p.friction),
        level * direction_factor(1.0, p.friction),
    )
    return min(max(observed, -backward), forward)
