r"""Friction laws under one interface: level while sliding, level to break away, parameters.

All laws share the parameters of :class:`~furuta_model.lugre.LuGre` and use what they know of it:

==========  ==============================================  =====================
law         sliding, v ≠ 0                                  breaks away beyond
==========  ==============================================  =====================
coulomb     α₀ sgn v, eq. (4)                               α₀
stiction    α₀ sgn v                                        α₀ + α₁
stribeck    (α₀ + α₁ exp(−(v/vs)²)) sgn v                   α₀ + α₁
lugre       bristle dynamics, eq. (5); in the mean the      (none: it creeps)
            Stribeck curve
==========  ==============================================  =====================

To each comes the viscous part σ₂v and the factor 1 ± asymmetry by direction. The first three are
true stick-slip laws: at v = 0 the arm stands still, and friction is what holds it, while that is
within the breakaway level.
"""

from __future__ import annotations

from typing import NamedTuple

from furuta_model.compiled import compiled
from furuta_model.lugre import LuGre, symmetric_level

LAWS = ("coulomb", "stiction", "stribeck", "lugre")
COULOMB, STICTION, STRIBECK, LUGRE = range(len(LAWS))


class FrictionLaw(NamedTuple):
    """A law (index into :data:`LAWS`) with its parameters."""

    kind: int = LUGRE
    parameters: LuGre = LuGre()

    @property
    def name(self) -> str:
        """The law's name."""
        return LAWS[self.kind]


@compiled
def sliding_level(v: float, direction: float, law: FrictionLaw) -> float:
    """Friction [V] opposing a motion in ``direction`` (±1) at speed v [rad/s], viscous part apart.

    The direction is given beside the speed because at v = 0 a slide that begins or ends has one.
    """
    p = law.parameters
    symmetric = symmetric_level(v, p) if law.kind in (STRIBECK, LUGRE) else p.alpha0
    return symmetric * (1.0 + direction * p.asymmetry)


@compiled
def breakaway_level(direction: float, law: FrictionLaw) -> float:
    """Torque [V] up to which a resting arm is held against motion in ``direction`` (±1)."""
    p = law.parameters
    level = p.alpha0 if law.kind == COULOMB else p.alpha0 + p.alpha1
    return level * (1.0 + direction * p.asymmetry)


@compiled
def steady_friction(v: float, law: FrictionLaw) -> float:
    """F [V] of the law at steady speed v [rad/s], viscous part included; 0 at v = 0."""
    if v == 0.0:
        return 0.0
    direction = 1.0 if v > 0.0 else -1.0
    return direction * sliding_level(v, direction, law) + law.parameters.viscous * v
