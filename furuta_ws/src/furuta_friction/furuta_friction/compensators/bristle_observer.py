r"""Friction observer (9): simulates the bristle equation (5) with the estimated speed.

.. math::
    \dot{\hat z} = v - σ_0\frac{|v|}{g(v)}\hat z - K e, \qquad
    \hat F = σ_0\hat z + σ_1\dot{\hat z} + σ_2 v

The term with K is in none of the paper's equations. It is from [6], which the paper cites: e is
the position error of the joint with friction, here the arm angle φ, whose reference is zero. At
v = 0 the correction would move ẑ without limit. ẑ is therefore limited like the true z,
σ₀|ẑ| ≤ max g, and F̂ to the highest friction that the parameters allow at that speed.
"""

from dataclasses import dataclass

import numpy as np

from furuta_friction.compensator import Joint
from furuta_model.compiled import inlined
from furuta_model.friction.lugre import (
    deflection_rate,
    highest_level,
    stretched,
    stribeck_level,
)
from furuta_model.friction.parameters import Friction
from furuta_model.state import PHI, PHI_DOT


@dataclass
class BristleMemory:
    """Deflection ẑ of the bristle [rad]."""

    z: float = 0.0


@inlined
def estimate(memory: BristleMemory, x: np.ndarray, p: Joint) -> float:
    """F̂ [V] with the friction parameters as they are."""
    return observe(memory, x, p.friction, p)


@inlined
def observe(memory: BristleMemory, x: np.ndarray, p: Friction, joint: Joint) -> float:
    """Move ẑ by one sample and return F̂ [V], with the friction parameters ``p``."""
    v = x[PHI_DOT]
    return dry_friction(memory, v, x[PHI], p, joint) + p.viscous * v


@inlined
def dry_friction(memory: BristleMemory, v: float, angle: float, p: Friction, joint: Joint) -> float:
    """The same without viscous friction, for speed v [rad/s] and arm ``angle`` [rad]."""
    correction = -joint.observer_gain * angle
    level = stribeck_level(v, p)
    z, _, _ = stretched(v, v + correction, memory.z, joint.sample_time, level, p)
    highest = highest_level(p)
    limit = highest / p.sigma0
    z = min(max(z, -limit), limit)
    memory.z = z
    force = p.sigma0 * z + p.sigma1 * (deflection_rate(v, abs(v), z, level, p) + correction)
    return min(max(force, -highest), highest)
