"""Coulomb compensation, eq. (4): the level α₀ in the direction of the estimated speed."""

from __future__ import annotations

from furuta_model.compiled import inlined
from furuta_model.friction.laws import LAWS, FrictionLaw, steady_friction
from furuta_model.friction.parameters import Friction

_COULOMB = LAWS.index("coulomb")


@inlined
def estimate(v: float, p: Friction) -> float:
    """F̂ [V] with asymmetry and viscous part; 0 at v = 0."""
    return steady_friction(v, FrictionLaw(_COULOMB, p))
