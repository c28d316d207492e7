"""Disturbance observer: the friction that the estimator observes (Ohnishi 1987), limited.

The estimator's ``friction_process_noise`` sets its bandwidth.
"""

from math import isnan

import numpy as np

from furuta_friction.compensator import Joint
from furuta_friction.compensators.adaptive import LARGEST_FACTOR
from furuta_model.compiled import inlined
from furuta_model.friction.lugre import highest_level
from furuta_model.state import OBSERVED_FRICTION, PHI_DOT


@inlined
def estimate(x: np.ndarray, p: Joint) -> float:
    """F̂ [V]; without its viscous part at most the highest level that adaptation allows."""
    observed, viscous = x[OBSERVED_FRICTION], p.friction.viscous * x[PHI_DOT]
    limit = LARGEST_FACTOR * highest_level(p.friction)
    return 0.0 if isnan(observed) else min(max(observed - viscous, -limit), limit) + viscous
