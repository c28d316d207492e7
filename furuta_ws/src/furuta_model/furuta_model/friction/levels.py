"""Levels of friction by direction, and in other parameters, for compiled code."""

from furuta_model.compiled import inlined
from furuta_model.friction.parameters import Friction


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
