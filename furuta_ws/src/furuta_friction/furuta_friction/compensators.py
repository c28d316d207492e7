r"""Friction estimates F̂ [V] from the state estimate: eqs. (4) and (9), stiction, adaptation.

==========  ==========================================================================
none        0
coulomb     α₀ sgn v, eq. (4)
stiction    the same while the arm slides; at rest, below the Stribeck velocity, what
            friction is seen to hold, up to the breakaway level α₀ + α₁
lugre       the observer (9) with the correction of the work that the paper cites ([6])
adaptive    the same observer; a factor on its levels, one for each direction, follows
            the friction seen ([7])
==========  ==========================================================================

The observer runs the bristle's equation on the estimated speed:

.. math::
    \dot{\hat z} = v - σ_0\frac{|v|}{g(v)}\hat z - K e, \qquad
    \hat F = σ_0\hat z + σ_1\dot{\hat z} + σ_2 v

K appears in no equation of the paper. In [6] e is the position error of the joint with
friction; here that is the arm angle φ, whose reference is zero. The correction alone would
drive ẑ without limit while v = 0, so ẑ is kept where the true z must be, σ₀|ẑ| ≤ max g, and F̂
within the highest friction the parameters allow at that speed (:func:`largest_estimate`).

The friction *seen* is the one that the estimator finds between applied torque and motion. Where
it finds none (NaN, method lowpass) the stiction compensator does nothing at rest and the
adaptive one keeps its factors.
"""

from __future__ import annotations

from math import expm1, isnan
from typing import NamedTuple

import numpy as np

from furuta_friction.parameters import COMPENSATIONS, ObserverParameters
from furuta_model.compiled import compiled, inlined
from furuta_model.lugre import (
    LuGre,
    bristle_after,
    bristle_rate,
    highest_level,
    stribeck_level,
)
from furuta_model.state import EFFORT, PHI, PHI_DOT

# The compensator's memory: ẑ [rad], and what the adaptation adds to the levels' factor 1, for
# v > 0 and for v < 0.
MEMORY = 3
BRISTLE, RISING, FALLING = range(MEMORY)
# The adaptation keeps the factors between 1/3 and 3: beyond, it is the model that is wrong.
LARGEST_FACTOR = 3.0
# Part of its final deflection from which on the bristle counts as sliding.
SLIDING = 0.8

_COULOMB = COMPENSATIONS.index("coulomb")
_STICTION = COMPENSATIONS.index("stiction")
_LUGRE = COMPENSATIONS.index("lugre")
_ADAPTIVE = COMPENSATIONS.index("adaptive")


class Compensator(NamedTuple):
    """What :func:`estimate_friction` computes with."""

    kind: int
    friction: LuGre
    observer_gain: float
    adaptation_gain: float
    sample_time: float


def compensator(p: ObserverParameters) -> Compensator:
    """The compensator that the parameters name."""
    return Compensator(
        COMPENSATIONS.index(p.compensation),
        p.friction,
        p.observer_gain,
        p.adaptation_gain,
        p.sample_time,
    )


@inlined
def estimate_friction(memory: np.ndarray, estimate: np.ndarray, p: Compensator) -> float:
    """F̂ [V] for the state estimate (5,), x and the friction seen; ``memory`` (3,) is updated.

    The observer runs under every kind, so that a switch to it finds it converged.
    """
    v, seen = estimate[PHI_DOT], estimate[EFFORT]
    correction = -p.observer_gain * estimate[PHI]
    if p.kind == _ADAPTIVE:
        force = _observe(memory, v, correction, p.sample_time, _adapted(memory, p.friction))
        _adapt(memory, v, force, seen, p)
        return force
    force = _observe(memory, v, correction, p.sample_time, p.friction)
    if p.kind == _LUGRE:
        return force
    if p.kind == _STICTION:
        return stiction(v, seen, p.friction)
    if p.kind == _COULOMB:
        return coulomb(v, p.friction)
    return 0.0


@compiled
def largest_estimate(v: float, p: Compensator) -> float:
    """The largest F̂ [V], either way, at speed v [rad/s], whatever came before."""
    factor = LARGEST_FACTOR if p.kind == _ADAPTIVE else 1.0
    return factor * highest_level(p.friction) + p.friction.viscous * abs(v)


@compiled
def coulomb(v: float, p: LuGre) -> float:
    """F̂ [V] of eq. (4) with levels by direction and viscous part; 0 at v = 0."""
    if v > 0.0:
        return p.alpha0 * (1.0 + p.asymmetry) + p.viscous * v
    if v < 0.0:
        return -p.alpha0 * (1.0 - p.asymmetry) + p.viscous * v
    return 0.0


@compiled
def stiction(v: float, seen: float, p: LuGre) -> float:
    """F̂ [V] of Coulomb friction with stiction: what is ``seen`` at rest, up to breakaway."""
    if abs(v) > p.stribeck_velocity:
        return coulomb(v, p)
    if isnan(seen):
        return 0.0
    breakaway = p.alpha0 + p.alpha1
    return min(max(seen, -breakaway * (1.0 - p.asymmetry)), breakaway * (1.0 + p.asymmetry))


@inlined
def _observe(memory: np.ndarray, v: float, correction: float, dt: float, p: LuGre) -> float:
    """Move ẑ by one sample and return F̂ [V]."""
    z, _ = bristle_after(v, correction, memory[BRISTLE], dt, p)
    highest = highest_level(p)
    limit = highest / p.sigma0
    z = min(max(z, -limit), limit)
    memory[BRISTLE] = z
    force = p.sigma0 * z + p.sigma1 * (bristle_rate(v, z, p) + correction)
    return min(max(force, -highest), highest) + p.viscous * v


@inlined
def _adapted(memory: np.ndarray, p: LuGre) -> LuGre:
    """The friction with its levels as far as the adaptation has come."""
    rising = (1.0 + p.asymmetry) * (1.0 + memory[RISING])
    falling = (1.0 - p.asymmetry) * (1.0 + memory[FALLING])
    mean = 0.5 * (rising + falling)
    asymmetry = 0.5 * (rising - falling) / mean if mean > 0.0 else 0.0
    return LuGre(
        p.sigma0,
        p.sigma1,
        p.alpha0 * mean,
        p.alpha1 * mean,
        p.stribeck_velocity,
        p.viscous,
        asymmetry,
    )


@inlined
def _adapt(memory: np.ndarray, v: float, force: float, seen: float, p: Compensator) -> None:
    """Move the level of this direction towards the friction seen, at the rate Γ.

    Only while the bristle slides: before, it is σ₀ and σ₁ that decide F̂, and an error of theirs,
    or the delay with which friction is seen at a reversal, would be taken for one of the level.
    """
    if v == 0.0 or isnan(seen):
        return
    direction = RISING if v > 0.0 else FALLING
    factor = 1.0 + memory[direction]
    level = factor * stribeck_level(v, p.friction)
    if p.friction.sigma0 * memory[BRISTLE] * v < SLIDING * level * abs(v):
        return
    error = (seen - force) / (level if v > 0.0 else -level)
    factor *= 1.0 - expm1(-p.adaptation_gain * p.sample_time) * error
    memory[direction] = min(max(factor, 1.0 / LARGEST_FACTOR), LARGEST_FACTOR) - 1.0
