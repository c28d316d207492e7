"""Coulomb friction with stiction: α₀ opposes the motion, and the arm sticks up to α₀ + α₁.

At a sinusoidal speed it equals Coulomb friction, because the speed is zero only for an instant.
"""

from furuta_model.compiled import inlined
from furuta_model.friction.coulomb import level
from furuta_model.friction.law import Law
from furuta_model.friction.parameters import Friction


@inlined
def breakaway(p: Friction) -> float:
    """α₀ + α₁ [V]."""
    return p.alpha0 + p.alpha1


PART = Law("stiction", level, breakaway, constant=True)
