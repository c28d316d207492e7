r"""LuGre friction, eq. (5): bristle dynamics, with viscous part and levels by direction.

.. math::
    \dot z = v - σ_0\frac{|v|}{g(v)}z, \qquad g(v) = (α_0 + α_1 e^{-(v/v_s)^2})(1 ± a), \qquad
    F = σ_0 z + σ_1\dot z + σ_2 v

The sign is that of v, and a is the asymmetry. σ₂ (``viscous``) and a are zero in the paper. The
level at steady speed is that of Stribeck friction. Any law with presliding has these dynamics, with
its own g(v) (:func:`furuta_model.friction.laws.sliding_level`).

At constant v the equation is linear with rate λ = σ₀|v|/g(v), so the exact solution is known. It
replaces numerical integration and is valid at any speed and any step.
"""

from furuta_model.compiled import inlined
from furuta_model.elementary import fma, reduced_exponential, within
from furuta_model.friction.levels import direction_factor, static_level, stribeck_curve
from furuta_model.friction.parameters import SMALLEST_LEVEL, Friction

# Below this rate times step the decay comes from a series; −d is then not reduced (k = 0).
SMALL_DECAY = 0.3


@inlined
def stribeck_level(v: float, p: Friction) -> float:
    """g(v) [V]: the friction level at steady speed v [rad/s], without viscous part."""
    return max(stribeck_curve(v, p) * direction_factor(v, p), SMALLEST_LEVEL)


@inlined
def highest_level(p: Friction) -> float:
    """The largest g(v) [V]. If σ₀|z| is below it at the start, it stays below it."""
    return max(static_level(p) * (1.0 + abs(p.asymmetry)), SMALLEST_LEVEL)


@inlined
def deflection_rate(v: float, speed: float, z: float, level: float, p: Friction) -> float:
    """ż [rad/s] of (5) at deflection z [rad] and level g [V].

    ``speed`` is |v|. For a slide in a known direction give direction · v instead, which is smooth
    through v = 0.
    """
    return v - p.sigma0 * speed / max(level, SMALLEST_LEVEL) * z


@inlined
def force(v: float, z: float, level: float, p: Friction) -> float:
    """F [V] of (5) at deflection z [rad] and level g [V]."""
    return p.sigma0 * z + p.sigma1 * deflection_rate(v, abs(v), z, level, p) + p.viscous * v


@inlined
def stretched(
    v: float, drive: float, z: float, dt: float, level: float, p: Friction
) -> tuple[float, float, float]:
    """Exact solution of ż = drive − λz over ``dt`` [s] at constant v and level.

    Returns the deflection at the end, its mean [rad] and its mean rate [rad/s] over the step.
    ``drive`` [rad/s] is v, and for an observer v and its correction.
    """
    rate = p.sigma0 / max(level, SMALLEST_LEVEL) * abs(v)
    to_end, to_mean = decay_fractions(rate * dt)
    z_dot = drive - rate * z
    step = dt * z_dot
    return z + step * to_end, z + step * to_mean, z_dot * to_end


@inlined
def decay_fractions(d: float) -> tuple[float, float]:
    r"""Change of a decaying quantity, as a fraction of its initial rate times the step.

    .. math:: φ = (1 - e^{-d})/d, \qquad ψ = (1 - φ)/d

    φ is the change at the end of the step, ψ its mean over the step; d ≥ 0 is the decay rate times
    the step. For small d the differences would cancel: there ψ is the series of
    :math:`(e^{-d} - 1 + d)/d^2`, which the exponential is made from anyway.
    """
    r, curvature, scale = reduced_exponential(within(-d))
    if d < SMALL_DECAY:
        return 1.0 - d * curvature, curvature
    inverse = 1.0 / d
    end = -fma(scale, fma(r * r, curvature, r), scale - 1.0) * inverse
    return end, (1.0 - end) * inverse
