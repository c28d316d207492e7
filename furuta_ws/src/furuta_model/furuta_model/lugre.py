r"""LuGre friction, eq. (5), with viscous part and levels that differ by direction.

.. math::
    \dot z = v - σ_0\frac{|v|}{g(v)}z, \qquad g(v) = (α_0 + α_1 e^{-(v/v_s)^2})(1 ± a), \qquad
    F = σ_0 z + σ_1\dot z + σ_2 v

The sign is that of v, a the asymmetry; σ₂ (``viscous``) and a are zero in the paper. While v is
constant the bristle's equation is linear with rate λ = σ₀|v|/g(v), so its solution is known:
it is used instead of a numerical one and holds at any speed and any step.
"""

from __future__ import annotations

from math import exp, expm1
from typing import Annotated, NamedTuple

from furuta_model.compiled import compiled
from furuta_model.parameters import About

# Below this level [V] friction counts as absent: the bristle's rate stays finite.
SMALLEST_LEVEL = 1e-12
# Above this (v/vs)² stiction is gone: what is left of it is lost in the rounding of α₀.
LARGE_RATIO = 50.0
# Below this rate times step the rational form of the decay is exact to rounding, and faster.
SMALL_DECAY = 0.3


class LuGre(NamedTuple):
    """Parameters of (5). Defaults: the paper's, Fig. 8.

    The Stribeck velocity is not in the paper. 0.05 rad/s is a tenth of the limit cycle's speed,
    so α₁ acts at reversals alone, as stiction does.
    """

    sigma0: Annotated[float, About("bristle stiffness σ₀", "V/rad", 1e-3, 1e6)] = 80.0
    sigma1: Annotated[float, About("bristle damping σ₁", "V s/rad", 0.0, 1e3)] = 1.5
    alpha0: Annotated[float, About("Coulomb level α₀", "V", 0.0, 100.0)] = 0.21
    alpha1: Annotated[float, About("stiction above the Coulomb level α₁", "V", 0.0, 100.0)] = 0.022
    stribeck_velocity: Annotated[float, About("Stribeck velocity", "rad/s", 1e-6, 100.0)] = 0.05
    viscous: Annotated[float, About("viscous friction σ₂", "V s/rad", 0.0, 100.0)] = 0.0
    asymmetry: Annotated[
        float,
        About("levels are (1 + asymmetry) times for v > 0, (1 - asymmetry) for v < 0", "", -1, 1),
    ] = 0.0


@compiled
def symmetric_level(v: float, p: LuGre) -> float:
    """α₀ + α₁ exp(−(v/vs)²) [V]: the level at speed v [rad/s] before its asymmetry."""
    ratio = v / p.stribeck_velocity
    if ratio * ratio > LARGE_RATIO:
        return p.alpha0
    return p.alpha0 + p.alpha1 * exp(-ratio * ratio)


@compiled
def stribeck_level(v: float, p: LuGre) -> float:
    """g(v) [V]: the friction level at steady speed v [rad/s], viscous part excluded."""
    level = symmetric_level(v, p)
    if v > 0.0:
        level *= 1.0 + p.asymmetry
    elif v < 0.0:
        level *= 1.0 - p.asymmetry
    return max(level, SMALLEST_LEVEL)


@compiled
def highest_level(p: LuGre) -> float:
    """The largest g(v) [V]; σ₀|z| never exceeds it once it does not."""
    return max((p.alpha0 + p.alpha1) * (1.0 + abs(p.asymmetry)), SMALLEST_LEVEL)


@compiled
def bristle_rate(v: float, z: float, p: LuGre) -> float:
    """ż [rad/s] of (5) at speed v [rad/s] and deflection z [rad]."""
    return v - p.sigma0 * abs(v) / stribeck_level(v, p) * z


@compiled
def friction(v: float, z: float, p: LuGre) -> float:
    """F [V] of (5) at speed v [rad/s] and deflection z [rad]."""
    return p.sigma0 * z + p.sigma1 * bristle_rate(v, z, p) + p.viscous * v


@compiled
def steady_friction(v: float, p: LuGre) -> float:
    """F [V] after a long time at speed v [rad/s]: the Stribeck curve with viscous part."""
    if v == 0.0:
        return 0.0
    return (stribeck_level(v, p) if v > 0.0 else -stribeck_level(v, p)) + p.viscous * v


@compiled
def bristle_after(
    v: float, correction: float, z: float, dt: float, p: LuGre
) -> tuple[float, float]:
    """Exact solution of ż = v + correction − λz over ``dt`` [s] at constant speed v [rad/s].

    Returns the deflection at the end and its mean over the step [rad]. ``correction`` [rad/s] is an
    observer's correction, zero for the plant.
    """
    rate = p.sigma0 / stribeck_level(v, p) * abs(v)
    to_end, to_mean = decay_fractions(rate * dt)
    step = dt * (v + correction - rate * z)
    return z + step * to_end, z + step * to_mean


@compiled
def decay_fractions(d: float) -> tuple[float, float]:
    r"""Parts of its first rate times the step that a decaying quantity has moved: end, mean.

    .. math:: φ = (1 - e^{-d})/d, \qquad ψ = (1 - φ)/d

    where d ≥ 0 is rate times step. For small d by the (5, 5) Padé approximant of :math:`e^{-d}`, in
    which what would cancel has cancelled.
    """
    if d >= SMALL_DECAY:
        end = -expm1(-d) / d
        return end, (1.0 - end) / d
    s = d * d
    odd = 0.5 + s * (1.0 / 72.0 + s / 30240.0)
    below = 1.0 + s * (1.0 / 9.0 + s / 1008.0) + d * odd
    return 2.0 * odd / below, (odd + d * (1.0 / 12.0 + s / 1080.0)) / below
