"""Means of a friction law's level over a sinusoidal speed, and its slope.

With a closed form where there is one, from the level itself otherwise.
"""

from collections.abc import Callable

import numpy as np

from furuta_model.friction.law import Law
from furuta_model.friction.levels import stribeck_curve
from furuta_model.friction.parameters import Friction

# Relative step of the central difference for the slope.
STEP = 1e-6


def fundamental_level(amplitude: float, law: Law, p: Friction) -> float:
    """The constant level [V] with the same fundamental at amplitude A [rad/s]."""
    if law.constant:
        return law.level(0.0, p)
    if law.fundamental is not None:
        return law.fundamental(amplitude, p)
    if law.level is stribeck_curve:
        from scipy.special import dawsn

        ratio = amplitude / p.stribeck_velocity
        return p.alpha0 + p.alpha1 * float(dawsn(ratio)) / ratio
    return _quarter_cycle(lambda x: law.level(amplitude * np.sin(x), p) * np.sin(x))


def mean_level(amplitude: float, law: Law, p: Friction) -> float:
    """Mean level [V] over a cycle of amplitude A [rad/s]."""
    if law.constant:
        return law.level(0.0, p)
    if law.mean is not None:
        return law.mean(amplitude, p)
    if law.level is stribeck_curve:
        from scipy.special import i0e

        ratio = amplitude / p.stribeck_velocity
        return p.alpha0 + p.alpha1 * float(i0e(0.5 * ratio * ratio))
    return _quarter_cycle(lambda x: law.level(amplitude * np.sin(x), p)) * 2.0 / np.pi


def level_slope(v: float, law: Law, p: Friction) -> float:
    """dg/dv [V s/rad] at speed v > 0 [rad/s]."""
    if law.constant:
        return 0.0
    if law.slope is not None:
        return law.slope(v, p)
    if law.level is stribeck_curve:
        ratio = v / p.stribeck_velocity
        return float(-2.0 * abs(ratio) / p.stribeck_velocity * p.alpha1 * np.exp(-ratio * ratio))
    h = STEP * v
    return (law.level(v + h, p) - law.level(v - h, p)) / (2.0 * h)


def _quarter_cycle(integrand: Callable[[float], float]) -> float:
    from scipy.integrate import quad

    return float(quad(integrand, 0.0, 0.5 * np.pi, epsabs=1e-13, epsrel=1e-11, limit=200)[0])
