r"""The bristle's motion in the model that is fitted, with the C library's exponential.

It is :func:`furuta_model.friction.lugre.bristle_after` to 1e-15. The fit of a tumbling pendulum has
several optima near each other, and a change of 1e-15 ends in another one. The fit therefore keeps
its own arithmetic: the C library's exponential, and the (5, 5) Padé approximant of short steps.
"""

from __future__ import annotations

from math import exp, expm1

from furuta_model.compiled import compiled
from furuta_model.friction.bristle import SMALL_DECAY
from furuta_model.friction.parameters import SMALLEST_LEVEL, Friction
from furuta_model.friction.stribeck import LARGE_RATIO


@compiled
def bristle_after(v: float, z: float, dt: float, p: Friction) -> tuple[float, float]:
    """Deflection [rad] after ``dt`` [s] at constant speed v [rad/s], and its mean over the step."""
    rate = p.sigma0 / max(_level(v, p), SMALLEST_LEVEL) * abs(v)
    to_end, to_mean = _decay_fractions(rate * dt)
    step = dt * (v + 0.0 - rate * z)
    return z + step * to_end, z + step * to_mean


@compiled
def _level(v: float, p: Friction) -> float:
    """g(v) [V]."""
    ratio = v / p.stribeck_velocity
    level = p.alpha0
    if ratio * ratio <= LARGE_RATIO:
        level = p.alpha0 + p.alpha1 * exp(-ratio * ratio)
    if v > 0.0:
        level *= 1.0 + p.asymmetry
    elif v < 0.0:
        level *= 1.0 - p.asymmetry
    return level


@compiled
def _decay_fractions(d: float) -> tuple[float, float]:
    """Change at the end of a step and its mean, as fractions of initial rate times step."""
    if d >= SMALL_DECAY:
        end = -expm1(-d) / d
        return end, (1.0 - end) / d
    s = d * d
    odd = 0.5 + s * (1.0 / 72.0 + s / 30240.0)
    below = 1.0 + s * (1.0 / 9.0 + s / 1008.0) + d * odd
    return 2.0 * odd / below, (odd + d * (1.0 / 12.0 + s / 1080.0)) / below
