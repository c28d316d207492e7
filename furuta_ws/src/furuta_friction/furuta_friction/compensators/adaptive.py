"""Adaptive compensation ([7]): the observer (9) with levels that follow the observed friction.

A factor on the levels, one for each direction of motion, is adapted at the rate Γ.
"""

from __future__ import annotations

from math import isnan

import numpy as np

from furuta_friction.compensators.bristle_observer import BRISTLE, observe
from furuta_model.compiled import inlined
from furuta_model.elementary import expm1
from furuta_model.friction.lugre import stribeck_level
from furuta_model.friction.parameters import Friction

# Index in the compensators' memory: factor on the levels minus 1, for v > 0 and v < 0.
FORWARD, BACKWARD = 1, 2
# The factors stay between 1/3 and 3. Larger errors are errors of the model, not of the level.
LARGEST_FACTOR = 3.0
# Fraction of its final deflection above which the bristle counts as sliding.
SLIDING = 0.8


@inlined
def estimate(
    memory: np.ndarray,
    v: float,
    observed: float,
    correction: float,
    rate: float,
    dt: float,
    p: Friction,
) -> float:
    """F̂ [V] at speed v [rad/s]; the levels move towards the ``observed`` friction [V].

    ``rate`` is Γ [1/s], ``correction`` the observer's −Ke [rad/s], ``dt`` the sample time [s].
    """
    force = observe(memory, v, correction, dt, adapted(memory, p))
    _adapt(memory, v, force, observed, rate * dt, p)
    return force


@inlined
def adapted(memory: np.ndarray, p: Friction) -> Friction:
    """The friction parameters with the adapted levels."""
    forward = (1.0 + p.asymmetry) * (1.0 + memory[FORWARD])
    backward = (1.0 - p.asymmetry) * (1.0 + memory[BACKWARD])
    mean = 0.5 * (forward + backward)
    asymmetry = 0.5 * (forward - backward) / mean if mean > 0.0 else 0.0
    return Friction(
        p.sigma0,
        p.sigma1,
        p.alpha0 * mean,
        p.alpha1 * mean,
        p.stribeck_velocity,
        p.viscous,
        asymmetry,
    )


@inlined
def _adapt(
    memory: np.ndarray, v: float, force: float, observed: float, step: float, p: Friction
) -> None:
    """Adapt the level of the present direction to the observed friction; ``step`` is Γ·dt.

    Only while the bristle slides. In presliding F̂ depends on σ₀ and σ₁. Errors in them, and the
    delay of the observed friction at a reversal, would look like an error of the level.
    """
    if v == 0.0 or isnan(observed):
        return
    forward = v > 0.0
    factor = 1.0 + (memory[FORWARD] if forward else memory[BACKWARD])
    level = factor * stribeck_level(v, p)
    if p.sigma0 * memory[BRISTLE] * v < SLIDING * level * abs(v):
        return
    error = (observed - force) / (level if v > 0.0 else -level)
    factor *= 1.0 - expm1(-step) * error
    adapted_to = min(max(factor, 1.0 / LARGEST_FACTOR), LARGEST_FACTOR) - 1.0
    # An index that depends on the speed could not be vectorised.
    if forward:
        memory[FORWARD] = adapted_to
    else:
        memory[BACKWARD] = adapted_to


def at_limit(memory: np.ndarray) -> bool:
    """Whether a level has adapted as far as it may: the friction is not as the parameters say."""
    factors = 1.0 + memory[[FORWARD, BACKWARD]]
    return bool(np.any((factors <= 1.0 / LARGEST_FACTOR) | (factors >= LARGEST_FACTOR)))
