r"""Dahl friction: a bristle without damping, with the Coulomb level at any speed.

.. math:: \dot F = σ_0 \left(v - \frac{|v|}{α_0} F\right) + σ_2 \dot v

It is eq. (5) with σ₁ = 0 and g(v) = α₀: Dahl's model with exponent 1 (P. R. Dahl, *A solid friction
model*, The Aerospace Corporation, 1968). The exact solution at constant speed is that of
:mod:`.bristle`. Friction depends on the path alone, not on the speed along it.
"""

from furuta_model.friction.coulomb import breakaway, level
from furuta_model.friction.law import Law

PART = Law("dahl", level, breakaway, bristle=True, damped=False, constant=True)
