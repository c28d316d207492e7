r"""LuGre friction, eq. (5), with viscous part and levels that differ by direction.

.. math::
    \dot z = v - σ_0\frac{|v|}{g(v)}z, \qquad g(v) = (α_0 + α_1 e^{-(v/v_s)^2})(1 ± a), \qquad
    F = σ_0 z + σ_1\dot z + σ_2 v

The sign is that of v, and a is the asymmetry. σ₂ (``viscous``) and a are zero in the paper. The
level at steady speed is that of Stribeck friction.
"""

from furuta_model.compiled import inlined
from furuta_model.friction import stribeck
from furuta_model.friction.bristle import deflection_rate, force, stretched
from furuta_model.friction.levels import direction_factor
from furuta_model.friction.parameters import SMALLEST_LEVEL, Friction

PART = stribeck.PART._replace(name="lugre", bristle=True)
_symmetric_level = stribeck.level


@inlined
def stribeck_level(v: float, p: Friction) -> float:
    """g(v) [V]: the friction level at steady speed v [rad/s], without viscous part."""
    return max(_symmetric_level(v, p) * direction_factor(v, p), SMALLEST_LEVEL)


@inlined
def highest_level(p: Friction) -> float:
    """The largest g(v) [V]. If σ₀|z| is below it at the start, it stays below it."""
    return max((p.alpha0 + p.alpha1) * (1.0 + abs(p.asymmetry)), SMALLEST_LEVEL)


@inlined
def bristle_rate(v: float, z: float, p: Friction) -> float:
    """ż [rad/s] of (5) at speed v [rad/s] and deflection z [rad]."""
    return deflection_rate(v, abs(v), z, stribeck_level(v, p), p)


@inlined
def friction(v: float, z: float, p: Friction) -> float:
    """F [V] of (5) at speed v [rad/s] and deflection z [rad]."""
    return force(v, z, stribeck_level(v, p), p)


@inlined
def bristle_after(
    v: float, correction: float, z: float, dt: float, p: Friction
) -> tuple[float, float]:
    """Deflection [rad] after ``dt`` [s] at constant speed v [rad/s], and its mean over the step.

    ``correction`` [rad/s] is that of an observer, zero for the plant.
    """
    end, mean, _ = stretched(v, v + correction, z, dt, stribeck_level(v, p), p)
    return end, mean
