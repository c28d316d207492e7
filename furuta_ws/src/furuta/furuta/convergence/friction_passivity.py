r"""Passivity of LuGre friction from v to F, [4] Barabanov and Ortega.

With the bristle's energy S = σ₀z²/2 as storage, ζ = σ₀z sgn v and (5),

.. math::
    Fv - \dot S = \frac{|v|}{g(v)}
        \left[ζ^2 - σ_1|v|ζ + (σ_1 + σ_2)|v|g(v)\right]

Since |ζ| never exceeds max g = α₀ + α₁, the bracket is never negative if
σ₁ max g ≤ (σ₁ + σ₂) min g, that is

.. math::
    σ_2 α_0 \ge σ_1 α_1

The condition is also necessary, for any storage function: a bristle bent slowly to max g, which
takes a bounded energy, and then moved by x at a high speed V returns, to leading order, the energy
V [σ₁α₁(1 − exp(−σ₀x/α₀))/σ₀ − σ₂x]. For small x this is a positive multiple of V if the condition
fails. Asymmetry scales all levels of one direction equally and does not change the condition.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from furuta_model.friction.parameters import Friction
from furuta_model.friction.stribeck import level as symmetric_level


class FrictionPassivity(NamedTuple):
    """Whether friction is passive, the σ₂ [V s/rad] required, and its passive speeds [rad/s]."""

    passive: bool
    viscous_needed: float
    up_to_rad_s: float


def friction_passivity(p: Friction) -> FrictionPassivity:
    """Check the condition of this module.

    Up to the speed ``up_to_rad_s`` no deflection within its bound returns energy. The speed is
    infinite if friction is passive.
    """
    passive = p.viscous * p.alpha0 >= p.sigma1 * p.alpha1
    needed = p.sigma1 * p.alpha1 / p.alpha0 if p.alpha0 > 0.0 else np.inf
    if p.alpha1 == 0.0 or p.sigma1 == 0.0:
        needed = 0.0
    return FrictionPassivity(passive, needed, np.inf if passive else _largest_speed(p))


def dissipation_margin(v: float, p: Friction, direction: float = 1.0) -> float:
    """Minimum of the bracket [V²] over |ζ| ≤ max g at speed v [rad/s]."""
    side = 1.0 + direction * p.asymmetry
    level, highest = symmetric_level(v, p) * side, (p.alpha0 + p.alpha1) * side
    worst = min(0.5 * p.sigma1 * abs(v), highest)
    return worst**2 - p.sigma1 * abs(v) * worst + (p.sigma1 + p.viscous) * abs(v) * level


def _largest_speed(p: Friction) -> float:
    """The speed [rad/s] at which the margin becomes negative; g falls with |v|, so it stays so."""
    return min(_largest_speed_in(p, side) for side in (1.0, -1.0) if 1.0 + side * p.asymmetry > 0.0)


def _largest_speed_in(p: Friction, direction: float) -> float:
    high = p.stribeck_velocity
    while dissipation_margin(high, p, direction) >= 0.0:
        high *= 2.0
        if not np.isfinite(high):
            return float("inf")
    low = high
    while dissipation_margin(low, p, direction) < 0.0:
        low *= 0.5
        if low == 0.0:
            return 0.0
    return float(brentq(lambda v: dissipation_margin(v, p, direction), low, high, rtol=1e-12))
