r"""Friction estimates F̂ [V] from the arm's motion, eqs. (4) and (9).

The LuGre observer runs the bristle's equation on the measured speed with the correction of the
work that the paper cites ([6]):

.. math::
    \dot{\hat z} = v - σ_0\frac{|v|}{g(v)}\hat z - K e, \qquad
    \hat F = σ_0\hat z + σ_1\dot{\hat z} + σ_2 v

K appears in no equation of the paper. In [6] e is the position error of the joint with
friction; here that is the arm angle φ, whose reference is zero. The correction alone would
drive ẑ without limit while v = 0, so ẑ is kept where the true z must be, σ₀|ẑ| ≤ max g, and F̂
within the highest friction the parameters allow at that speed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.lugre import LuGre, bristle_after, bristle_rate, highest_level
from furuta_model.state import PHI, PHI_DOT

from .parameters import COMPENSATIONS, ObserverParameters

# The observer's memory: the estimated deflection ẑ [rad].
MEMORY = 1

_COULOMB = COMPENSATIONS.index("coulomb")
_LUGRE = COMPENSATIONS.index("lugre")


class Compensator(NamedTuple):
    """What :func:`estimate_friction` computes with."""

    kind: int
    friction: LuGre
    observer_gain: float
    sample_time: float


def compensator(p: ObserverParameters) -> Compensator:
    """The compensator that the parameters name."""
    return Compensator(
        COMPENSATIONS.index(p.compensation), p.friction, p.observer_gain, p.sample_time
    )


@compiled
def estimate_friction(memory: np.ndarray, x: np.ndarray, p: Compensator) -> float:
    """F̂ [V] for the state estimate ``x`` (4,); ``memory`` (1,) is updated.

    The observer runs under every kind, so that a switch to it finds it converged.
    """
    v = x[PHI_DOT]
    push = -p.observer_gain * x[PHI]
    z, _ = bristle_after(v, push, memory[0], p.sample_time, p.friction)
    highest = highest_level(p.friction)
    limit = highest / p.friction.sigma0
    z = min(max(z, -limit), limit)
    memory[0] = z
    if p.kind == _COULOMB:
        return coulomb(v, p.friction)
    if p.kind == _LUGRE:
        force = p.friction.sigma0 * z + p.friction.sigma1 * (bristle_rate(v, z, p.friction) + push)
        return min(max(force, -highest), highest) + p.friction.viscous * v
    return 0.0


@compiled
def coulomb(v: float, p: LuGre) -> float:
    """F̂ [V] of eq. (4) with levels by direction and viscous part; 0 at v = 0."""
    if v > 0.0:
        return p.alpha0 * (1.0 + p.asymmetry) + p.viscous * v
    if v < 0.0:
        return -p.alpha0 * (1.0 - p.asymmetry) + p.viscous * v
    return 0.0
