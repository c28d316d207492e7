r"""Levels of friction: of the laws, by direction, and changed; for compiled code.

Coulomb friction, eq. (4), has the level α₀ at any speed, and the arm sticks up to the same level.
With stiction it sticks up to α₀ + α₁. At a sinusoidal speed both are equal, because the speed is
zero only for an instant. Stribeck friction falls from α₀ + α₁ at rest to α₀ above the Stribeck
velocity:

.. math:: g(v) = α_0 + α_1 e^{-(v/v_s)^2}
"""

from furuta_model.compiled import inlined
from furuta_model.elementary import exp
from furuta_model.friction.parameters import Friction

# Above this (v/vs)² the stiction term is below the rounding of α₀.
LARGE_RATIO = 50.0


@inlined
def coulomb_level(v: float, p: Friction) -> float:
    """α₀ [V] at any speed v [rad/s]."""
    return p.alpha0


@inlined
def static_level(p: Friction) -> float:
    """α₀ + α₁ [V], the level of stiction."""
    return p.alpha0 + p.alpha1


@inlined
def stribeck_curve(v: float, p: Friction) -> float:
    """α₀ + α₁ exp(−(v/vs)²) [V] at speed v [rad/s]."""
    ratio = v / p.stribeck_velocity
    if ratio * ratio > LARGE_RATIO:
        return p.alpha0
    return p.alpha0 + p.alpha1 * exp(-ratio * ratio)


@inlined
def direction_factor(direction: float, p: Friction) -> float:
    """1 ± asymmetry. Selecting a constant is faster than arithmetic with the direction."""
    return 1.0 + p.asymmetry if direction >= 0.0 else 1.0 - p.asymmetry


@inlined
def with_levels(p: Friction, alpha0: float, alpha1: float, asymmetry: float) -> Friction:
    """The parameters with other levels [V]; compiled code has no ``_replace``."""
    return Friction(
        sigma0=p.sigma0,
        sigma1=p.sigma1,
        alpha0=alpha0,
        alpha1=alpha1,
        stribeck_velocity=p.stribeck_velocity,
        viscous=p.viscous,
        asymmetry=asymmetry,
    )


@inlined
def copied(p: Friction) -> Friction:
    """The parameters as a named tuple, also from a block."""
    return with_levels(p, p.alpha0, p.alpha1, p.asymmetry)
