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
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.friction.lugre import (
    deflection_rate,
    highest_level,
    stretched,
    stribeck_level,
)
from furuta_model.friction.parameters import Friction
from furuta_model.state import PHI, PHI_DOT

# Time for which the arm counts as having moved at its present speed when the observer begins [s].
MOVED_BEFORE = 0.02


class Joint(NamedTuple):
    """What every compensator is told: friction, gain K [1/s] of (9), sample time [s]."""

    friction: Friction = Friction()
    observer_gain: float = 0.0
    sample_time: float = 0.0


@dataclass
class BristleMemory:
    """Deflection ẑ of the bristle [rad]."""

    z: float = 0.0


@inlined
def begin(memory: BristleMemory, x: np.ndarray, force: float, p: Joint) -> None:
    """Begin with a bristle that has had the ``force`` [V], and then moved at the present speed.

    A slow arm is hardly accelerated, so the force is known from the torque. That of a fast one is
    known from its direction.
    """
    v, friction = x[PHI_DOT], p.friction
    level, highest = stribeck_level(v, friction), highest_level(friction)
    z = min(max(force - friction.viscous * v, -highest), highest) / friction.sigma0
    memory.z, _, _ = stretched(v, v, z, MOVED_BEFORE, level, friction)


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
