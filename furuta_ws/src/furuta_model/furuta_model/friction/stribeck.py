r"""Stribeck friction: the level falls from α₀ + α₁ at rest to α₀ above the Stribeck velocity.

.. math:: g(v) = α_0 + α_1 e^{-(v/v_s)^2}
"""

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.elementary import exp
from furuta_model.friction.law import Law
from furuta_model.friction.parameters import Friction
from furuta_model.friction.stiction import breakaway

# Above this (v/vs)² the stiction term is below the rounding of α₀.
LARGE_RATIO = 50.0


@inlined
def level(v: float, p: Friction) -> float:
    """α₀ + α₁ exp(−(v/vs)²) [V] at speed v [rad/s]."""
    ratio = v / p.stribeck_velocity
    if ratio * ratio > LARGE_RATIO:
        return p.alpha0
    return p.alpha0 + p.alpha1 * exp(-ratio * ratio)


def fundamental(amplitude: float, p: Friction) -> float:
    """∫ g(A sin x) sin x dx over a quarter cycle [V]: Dawson's integral."""
    from scipy.special import dawsn  # noqa: PLC0415 - nodes, which never need it, start sooner

    ratio = amplitude / p.stribeck_velocity
    return p.alpha0 + p.alpha1 * float(dawsn(ratio)) / ratio


def mean(amplitude: float, p: Friction) -> float:
    """Mean of g(A sin x) over a cycle [V]: a modified Bessel function."""
    from scipy.special import i0e  # noqa: PLC0415 - nodes, which never need it, start sooner

    ratio = amplitude / p.stribeck_velocity
    return p.alpha0 + p.alpha1 * float(i0e(0.5 * ratio * ratio))


def slope(v: float, p: Friction) -> float:
    """dg/dv [V s/rad] at v > 0 [rad/s]."""
    ratio = v / p.stribeck_velocity
    return float(-2.0 * abs(ratio) / p.stribeck_velocity * p.alpha1 * np.exp(-ratio * ratio))


PART = Law("stribeck", level, breakaway, fundamental=fundamental, mean=mean, slope=slope)
