r"""Bristle dynamics of a friction law with presliding, eq. (5).

.. math:: \dot z = v - σ_0\frac{|v|}{g(v)}z, \qquad F = σ_0 z + σ_1\dot z + σ_2 v

g(v) is the law's level by direction (:func:`furuta_model.friction.laws.sliding_level`). At constant
v the equation is linear with rate λ = σ₀|v|/g(v), so the exact solution is known. It replaces
numerical integration and is valid at any speed and any step.
"""

from __future__ import annotations

from furuta_model.compiled import inlined
from furuta_model.elementary import expm1
from furuta_model.friction.parameters import SMALLEST_LEVEL, Friction

# Below this rate times step the rational form of the decay is exact to rounding, and it is faster.
SMALL_DECAY = 0.3


@inlined
def deflection_rate(v: float, speed: float, z: float, level: float, p: Friction) -> float:
    """ż [rad/s] of (5) at deflection z [rad] and level g [V].

    ``speed`` is |v|. For a slide in a known direction give direction · v instead, which is smooth
    through v = 0.
    """
    return v - p.sigma0 * speed / max(level, SMALLEST_LEVEL) * z


@inlined
def deflection_after(
    v: float, correction: float, z: float, dt: float, level: float, p: Friction
) -> tuple[float, float]:
    """Exact solution of ż = v + correction − λz over ``dt`` [s] at constant v and level.

    Returns the deflection at the end and its mean over the step [rad]. ``correction`` [rad/s] is
    that of an observer, zero for the plant.
    """
    rate = p.sigma0 / max(level, SMALLEST_LEVEL) * abs(v)
    to_end, to_mean = decay_fractions(rate * dt)
    step = dt * (v + correction - rate * z)
    return z + step * to_end, z + step * to_mean


@inlined
def decay_fractions(d: float) -> tuple[float, float]:
    r"""Change of a decaying quantity, as a fraction of its initial rate times the step.

    .. math:: φ = (1 - e^{-d})/d, \qquad ψ = (1 - φ)/d

    φ is the change at the end of the step, ψ its mean over the step; d ≥ 0 is the decay rate times
    the step. For small d they come from the (5, 5) Padé approximant of :math:`e^{-d}`, with the
    terms that would cancel removed analytically.
    """
    large = d >= SMALL_DECAY
    if large:
        above, below, mean = -expm1(-d), d, 0.0
    else:
        s = d * d
        odd = 0.5 + s * (1.0 / 72.0 + s / 30240.0)
        below = 1.0 + s * (1.0 / 9.0 + s / 1008.0) + d * odd
        above, mean = 2.0 * odd, odd + d * (1.0 / 12.0 + s / 1080.0)
    # Divisions are the dearest operations in many lanes, so both cases share them.
    end = above / below
    return end, (1.0 - end if large else mean) / below
