"""Adaptive compensation ([7]): the observer (9) with levels that follow the observed friction.

A factor on the levels, one for each direction of motion, is adapted at the rate Γ.
"""

from dataclasses import dataclass
from math import isnan
from typing import Annotated, NamedTuple

import numpy as np

from furuta_friction.compensators.bristle_observer import BristleMemory, Joint, observe
from furuta_model.compiled import inlined
from furuta_model.elementary import expm1
from furuta_model.friction.levels import with_levels
from furuta_model.friction.lugre import stribeck_level
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import About
from furuta_model.state import PHI_DOT

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


class Adaptive(NamedTuple):
    """The design: the joint, and the rate at which levels adapt [1/s]."""

    joint: Joint
    rate: float


def design(joint: Joint, p: AdaptiveParameters) -> Adaptive:
    """The compensator for a joint."""
    return Adaptive(joint, p.adaptation_gain)


@inlined
def estimate(
    bristle: BristleMemory, memory: AdaptiveMemory, x: np.ndarray, observed: float, p: Adaptive
) -> float:
    """F̂ [V]; the levels move towards the ``observed`` friction [V]."""
    force = observe(bristle, x, adapted(memory, p.joint.friction), p.joint)
    _adapt(bristle, memory, x[PHI_DOT], observed, force, p)
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
def _adapt(
    bristle: BristleMemory,
    memory: AdaptiveMemory,
    v: float,
    observed: float,
    force: float,
    p: Adaptive,
) -> None:
    """Adapt the level of the present direction to the observed friction.

    Only while the bristle slides. In presliding F̂ depends on σ₀ and σ₁. Errors in them, and the
    delay of the observed friction at a reversal, would look like an error of the level.
    """
    friction = p.joint.friction
    if v == 0.0 or isnan(observed):
        return
    forward = v > 0.0
    factor = 1.0 + (memory.forward if forward else memory.backward)
    level = factor * stribeck_level(v, friction)
    if friction.sigma0 * bristle.z * v < SLIDING * level * abs(v):
        return
    error = (observed - force) / (level if v > 0.0 else -level)
    factor *= 1.0 - expm1(-(p.rate * p.joint.sample_time)) * error
    adapted_to = min(max(factor, 1.0 / LARGEST_FACTOR), LARGEST_FACTOR) - 1.0
    if forward:
        memory.forward = adapted_to
    else:
        memory.backward = adapted_to


def at_limit(memory: np.ndarray) -> bool:
    """Whether a level has adapted as far as it may: the friction is not as the parameters say."""
    factors = 1.0 + np.array((memory["forward"], memory["backward"]))
    return bool(np.any((factors <= 1.0 / LARGEST_FACTOR) | (factors >= LARGEST_FACTOR)))
