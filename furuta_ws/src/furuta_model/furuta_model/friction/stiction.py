"""Coulomb friction with stiction: α₀ against the motion, and the arm sticks up to α₀ + α₁.

Under a sinusoidal speed it is Coulomb friction: the speed is zero for no time at all.
"""

from __future__ import annotations

from furuta_model.compiled import compiled
from furuta_model.friction.coulomb import level
from furuta_model.friction.law import Law
from furuta_model.friction.parameters import LuGre


@compiled
def breakaway(p: LuGre) -> float:
    """α₀ + α₁ [V]."""
    return p.alpha0 + p.alpha1


LAW = Law("stiction", level, breakaway, constant=True)
