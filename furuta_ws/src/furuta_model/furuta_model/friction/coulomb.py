"""Coulomb friction, eq. (4): α₀ opposes the motion, and the arm sticks up to the same level."""

from furuta_model.compiled import inlined
from furuta_model.friction.law import Law
from furuta_model.friction.parameters import Friction


@inlined
def level(v: float, p: Friction) -> float:
    """α₀ [V] at any speed v [rad/s]."""
    return p.alpha0


@inlined
def breakaway(p: Friction) -> float:
    """α₀ [V]."""
    return p.alpha0


PART = Law("coulomb", level, breakaway, constant=True)
