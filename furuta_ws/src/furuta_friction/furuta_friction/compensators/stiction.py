"""Stiction compensation: Coulomb friction while the arm slides, the observed friction at rest.

The arm counts as at rest below the Stribeck velocity. The estimate is limited to the breakaway
level α₀ + α₁.
"""

from __future__ import annotations

from math import isnan

from furuta_friction.compensators import coulomb
from furuta_model.compiled import inlined
from furuta_model.friction.laws import LAWS, FrictionLaw, breakaway_level
from furuta_model.friction.parameters import Friction

_STICTION = LAWS.index("stiction")


@inlined
def estimate(v: float, observed: float, p: Friction) -> float:
    """F̂ [V] at speed v [rad/s] with the ``observed`` friction [V]; 0 at rest if that is NaN."""
    if abs(v) > p.stribeck_velocity:
        return coulomb.estimate(v, p)
    if isnan(observed):
        return 0.0
    law = FrictionLaw(_STICTION, p)
    return min(max(observed, -breakaway_level(-1.0, law)), breakaway_level(1.0, law))
