"""Adaptive compensation ([7]): the observer (9) with levels that follow the observed friction.

A factor on the levels, one for each direction of motion, is adapted at the rate Γ.
"""

from dataclasses import dataclass
from math import isnan
from typing import Annotated, Any, NamedTuple

import numpy as np

from furuta_friction.compensator import Compensator
from furuta_friction.compensators.bristle_observer import observe
from furuta_model.compiled import inlined
from furuta_model.elementary import expm1
from furuta_model.friction.levels import with_levels
from furuta_model.friction.lugre import stribeck_level
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import About
from furuta_model.state import OBSERVED_FRICTION, PHI_DOT

# The factors stay between 1/3 and 3. Larger errors are errors of the model, not of the level.
LARGEST_FACTOR = 3.0
# Fraction of its final deflection above which the bristle counts as sliding.
SLIDING = 0.8


@dataclass
class AdaptiveMemory:
    """Factor on the levels minus 1, for v > 0 and for v < 0."""

    forward: float = 0.0
    backward: float = 0.0


class AdaptiveParameters(NamedTuple):
    """Parameters of the compensator."""

    adaptation_gain: Annotated[
        float, About("adaptive: rate at which a level adapts while the arm slides", "1/s", 0, 1e3)
    ] = 20.0


@inlined
def estimate(memory: Any, x: np.ndarray, p: Any) -> float:
    """F̂ [V]; the levels move towards the observed friction."""
    force = observe(memory, x, adapted(memory.parts.adaptive, p.friction), p)
    _adapt(memory, x, force, p)
    return force


@inlined
def adapted(memory: AdaptiveMemory, p: Friction) -> Friction:
    """The friction parameters with the adapted levels."""
    forward = (1.0 + p.asymmetry) * (1.0 + memory.forward)
    backward = (1.0 - p.asymmetry) * (1.0 + memory.backward)
    mean = 0.5 * (forward + backward)
    asymmetry = 0.5 * (forward - backward) / mean if mean > 0.0 else 0.0
    return with_levels(p, p.alpha0 * mean, p.alpha1 * mean, asymmetry)


@inlined
def _adapt(memory: Any, x: np.ndarray, force: float, p: Any) -> None:
    """Adapt the level of the present direction to the observed friction.

    Only while the bristle slides. In presliding F̂ depends on σ₀ and σ₁. Errors in them, and the
    delay of the observed friction at a reversal, would look like an error of the level.
    """
    v, observed, levels = x[PHI_DOT], x[OBSERVED_FRICTION], memory.parts.adaptive
    if v == 0.0 or isnan(observed):
        return
    forward = v > 0.0
    factor = 1.0 + (levels.forward if forward else levels.backward)
    level = factor * stribeck_level(v, p.friction)
    if p.friction.sigma0 * memory.bristle * v < SLIDING * level * abs(v):
        return
    error = (observed - force) / (level if v > 0.0 else -level)
    factor *= 1.0 - expm1(-(p.parts.adaptive.adaptation_gain * p.sample_time)) * error
    adapted_to = min(max(factor, 1.0 / LARGEST_FACTOR), LARGEST_FACTOR) - 1.0
    if forward:
        levels.forward = adapted_to
    else:
        levels.backward = adapted_to


def at_limit(memory: np.ndarray) -> bool:
    """Whether a level has adapted as far as it may: the friction is not as the parameters say."""
    factors = 1.0 + np.array((memory["forward"], memory["backward"]))
    return bool(np.any((factors <= 1.0 / LARGEST_FACTOR) | (factors >= LARGEST_FACTOR)))


PART = Compensator(
    "adaptive",
    "LuGre observer with levels that follow the observed friction",
    estimate,
    needs_observed_friction=True,
    runs_observer=True,
    largest_factor=LARGEST_FACTOR,
    parameters=AdaptiveParameters,
    inline=True,
    memory=AdaptiveMemory,
)
