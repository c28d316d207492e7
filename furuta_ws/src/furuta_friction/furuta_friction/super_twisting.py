r"""Super-twisting rejection of friction, as an integral sliding mode on the arm's speed.

.. math::
    s = \frac{1}{b}\Bigl(\dot φ - \int (A - BL)_{\dot φ}\,x\,dt\Bigr), \qquad
    v = -1.5\sqrt{C}\sqrt{|s|}\,\mathrm{sgn}\,s + w, \qquad \dot w = -1.1\,C\,\mathrm{sgn}\,s

The sliding variable s [V s] is how much friction has changed the arm's speed (Utkin and Shi 1996).
The correction v is added to u = −Lx. C [V/s] bounds the rate at which friction changes. The gains
are those of Levant (Int. J. Control 58, 1993).

A bandwidth k [1/s] limits the gain of s: within the layer |s| < 2.25 C/k² both terms are linear,
:math:`v = -ks + w, \dot w = -0.49\,k^2 s`. The noise of the speed then causes no chatter. s also
passes a low-pass filter with the rate 3k. Between motor and arm a belt turns the phase by half a
turn, and without the filter the correction would drive its vibration. A vibration that is sustained
nevertheless reduces k (:mod:`furuta_friction.vibration`).

The law is homogeneous: C times a strength gives the correction for s divided by the strength, times
the strength. It is computed so. The integral is then scaled as well, and nothing jumps where the
strength changes slowly.
"""

from dataclasses import dataclass, field
from math import copysign, expm1, sqrt
from typing import Annotated, NamedTuple

import numpy as np

from furuta_friction import vibration
from furuta_friction.vibration import (
    Vibration,
    VibrationMemory,
    part_without_vibration,
)
from furuta_model.compiled import inlined
from furuta_model.linear import linearize
from furuta_model.parameters import OFF_AT_ZERO
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI_DOT, THETA, THETA_DOT

# Rate at which friction may change, relative to its highest level [1/s]: the gain C for a level.
FRICTION_RATE = 43.0
# Gains of the root and of the integral.
ROOT, INTEGRAL = 1.5, 1.1
# Rate of the low-pass filter relative to the bandwidth.
ROLL_OFF = 3.0
# Part of a law with a bandwidth at its start, so that it does not excite a vibration.
FIRST_PART = 0.25
# The layer without a bandwidth [V s].
NO_LAYER = 1e-300
# Lowest bandwidth [1/s]; below it the layer would overflow, and no correction is left.
LOWEST = 1e-100


@dataclass
class SuperTwistingMemory:
    """Whether it has started, the arm's speed without friction [rad/s], s [V s] and w [V].

    s and w are those for C alone.
    """

    started: bool = False
    speed: float = 0.0
    sliding: float = 0.0
    correction: float = 0.0
    vibration: VibrationMemory = field(default_factory=VibrationMemory)


class SuperTwisting(NamedTuple):
    """The sampled law: C [V/s] (0: off), (A − BL) of φ̇, b [rad/s²/V], dt [s].

    ``layer`` [V s] is that of the bandwidth, ``share`` that of a new value in the filtered s.
    """

    rate_bound: Annotated[float, OFF_AT_ZERO]
    layer: float
    share: float
    a1: float
    a2: float
    a3: float
    a4: float
    b: float
    dt: float
    first_part: float
    vibration: Vibration


def design_for_pendulum(
    rate_bound: float,
    bandwidth: float,
    vibration_limit: float,
    model: FurutaPendulum,
    viscous: float,
    gain: tuple[float, ...],
    dt: float,
) -> SuperTwisting:
    """The law for the feedback ``gain`` L (4,); ``viscous`` friction [V s/rad] is in the model."""
    a, b = linearize(model, viscous)
    closed = tuple((a[PHI_DOT] - b[PHI_DOT] * np.array(gain)).tolist())
    return design(rate_bound, bandwidth, vibration_limit, closed, float(b[PHI_DOT]), dt)


def design(
    rate_bound: float,
    bandwidth: float,
    vibration_limit: float,
    closed: tuple[float, ...],
    b: float,
    dt: float,
) -> SuperTwisting:
    """The law for the row ``closed`` (4,) of A − BL, and ``b``, of φ̇."""
    a1, a2, a3, a4 = closed
    limited = bandwidth > 0.0
    layer = rate_bound * (ROOT / max(bandwidth, LOWEST)) ** 2 if limited else 0.0
    return SuperTwisting(
        rate_bound=rate_bound,
        layer=max(layer, NO_LAYER),
        share=-expm1(-ROLL_OFF * bandwidth * dt) if limited else 1.0,
        a1=a1,
        a2=a2,
        a3=a3,
        a4=a4,
        b=b,
        dt=dt,
        first_part=FIRST_PART if limited else 1.0,
        vibration=vibration.design(vibration_limit, dt),
    )


@inlined
def correction(
    memory: SuperTwistingMemory,
    x: np.ndarray,
    error: float,
    strength: float,
    limit: float,
    p: SuperTwisting,
) -> float:
    """The correction v [V] for state ``x`` and arm error [rad], with C times ``strength`` > 0.

    The integral is at most ``limit`` [V] times ``strength``.
    """
    v = twist(memory, x[PHI_DOT], strength, limit, p)
    acceleration = p.a1 * error + p.a2 * x[PHI_DOT] + p.a3 * x[THETA] + p.a4 * x[THETA_DOT]
    memory.speed += p.dt * acceleration
    return v


@inlined
def twist(
    memory: SuperTwistingMemory, speed: float, strength: float, limit: float, p: SuperTwisting
) -> float:
    """The correction v [V] for the ``speed``; ``memory.speed`` is that without friction."""
    if not memory.started:
        memory.started, memory.speed = True, speed
        memory.sliding = memory.correction = 0.0
        memory.vibration.part = p.first_part
    memory.sliding += p.share * ((speed - memory.speed) / (p.b * strength) - memory.sliding)
    s = memory.sliding
    linear = min(abs(s) / p.layer, 1.0)
    root = copysign(ROOT * sqrt(p.rate_bound * abs(s) * linear), s)
    part = part_without_vibration(memory.vibration, strength * root, p.vibration)
    w = memory.correction - copysign(INTEGRAL * p.rate_bound * p.dt * linear, s) * part * part
    memory.correction = min(max(w, -limit), limit)
    return strength * (memory.correction - root * part)
