r"""How an axis moves whose friction truly sticks, under a torque that is held between commands.

.. math::
    J\dot v = τ(t - d) - (B ± D)v
              - (1 ± a)\,(F_C + F_S e^{-(v/v_s)^2} + Cv^2 + L|τ|)\,\mathrm{sgn}\,v
              - f_0 - f_1 t - g_s\sin q - g_c\cos q - kq - \sum(c_n\cos nq + s_n\sin nq)

± is the sign of v. L is friction per torque of the drive, as of a gear under load. Between two
commands and within a step the loads on the right are constant, so a slide and its end are exact:
what a step leaves out is how they change within it.
"""

from math import exp, log
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import inlined

# Below this product of damping and time the exponential is its series.
SMALL = 1e-3
# Times [s] that are none, and slides and stops within a step; more are not looked for.
SHORTEST, MOST_EVENTS = 1e-12, 6


class AxisModel(NamedTuple):
    """Parameters of the equation above [kg m², N m, rad, s].

    ``offsets`` (r,) are those of each recording, ``waves`` (w, 3) the order, cosine and sine
    amplitude of each. A drift counts from time 0.
    """

    inertia: float
    alpha0: float
    viscous: float
    delay: float
    gravity_sin: float
    gravity_cos: float
    spring: float
    alpha1: float
    stribeck_velocity: float
    asymmetry: float
    viscous_difference: float
    drag: float
    drift: float
    load_friction: float
    offsets: np.ndarray
    waves: np.ndarray


class AxisData(NamedTuple):
    """What recordings move an axis by, on one time axis.

    ``edges`` and ``torque`` (m,): from an edge [s] on the torque holds. No step of the integration
    is longer than ``step`` [s].
    """

    edges: np.ndarray
    torque: np.ndarray
    step: float


@inlined
def integrals(damping: float, h: float) -> tuple[float, float]:
    """Once and twice the integral of the decay exp(-damping t) over h."""
    x = damping * h
    if abs(x) < SMALL:
        return h * (1.0 - x * (0.5 - x / 6.0)), h * h * (0.5 - x * (1.0 / 6.0 - x / 24.0))
    first = (1.0 - exp(-x)) / damping
    return first, (h - first) / damping


@inlined
def _slide(v: float, pull: float, damping: float, h: float) -> tuple[float, float]:
    """Speed and travel after h of v' = pull - damping v."""
    first, second = integrals(damping, h)
    rate = pull - damping * v
    return v + rate * first, v * h + rate * second


@inlined
def _time_to_rest(v: float, pull: float, damping: float) -> float:
    """When v' = pull - damping v reaches 0."""
    rate = pull - damping * v
    first = -v / rate if rate != 0.0 else 0.0
    x = damping * first
    if abs(x) < SMALL:
        return first * (1.0 + x * (0.5 + x / 3.0))
    return -log(max(1.0 - x, 1e-300)) / damping


@inlined
def level(speed: float, torque: float, m: AxisModel) -> float:
    """Level of friction at a speed under a torque of the drive, without its direction."""
    lasting = m.alpha0 + m.drag * speed * speed + m.load_friction * abs(torque)
    if m.alpha1 == 0.0:
        return lasting
    ratio = speed / m.stribeck_velocity
    return lasting + m.alpha1 * exp(-ratio * ratio)


@inlined
def _load(q: float, time: float, m: AxisModel) -> float:
    """What acts against the torque beside friction."""
    load = m.drift * time + m.spring * q
    if m.gravity_sin != 0.0 or m.gravity_cos != 0.0:
        load += m.gravity_sin * np.sin(q) + m.gravity_cos * np.cos(q)
    for k in range(m.waves.shape[0]):
        angle = m.waves[k, 0] * q
        load += m.waves[k, 1] * np.cos(angle) + m.waves[k, 2] * np.sin(angle)
    return load


class Slide(NamedTuple):
    """What the axis does next: stick, slide for a ``time`` [s], or slide until it ``stops``.

    ``after`` and ``travel`` are speed at its end and way. It slides to one side (``sign``) with
    v' = ``pull`` - ``damping`` v; load and level are those at ``position``, ``speed``, ``torque``.
    """

    sticks: bool
    stops: bool
    time: float
    after: float
    travel: float
    sign: float
    pull: float
    damping: float
    position: float
    speed: float
    torque: float


@inlined
def next_slide(
    q: float, v: float, torque: float, offset: float, time: float, left: float, m: AxisModel
) -> Slide:
    """The next slide, for ``left`` [s] at most, under a torque of the drive and an offset."""
    position = q + 0.5 * left * v
    net = torque - offset - _load(position, time, m)
    sign = 1.0 if (net if v == 0.0 else v) > 0.0 else -1.0
    one_side = 1.0 + sign * m.asymmetry
    sticks = v == 0.0 and abs(net) <= one_side * level(0.0, torque, m)
    damping = (m.viscous + sign * m.viscous_difference) / m.inertia
    pull, speed = (net - sign * one_side * level(v, torque, m)) / m.inertia, v
    if m.alpha1 != 0.0 or m.drag != 0.0:
        speed = v + 0.5 * left * (pull - damping * v)
        pull = (net - sign * one_side * level(speed, torque, m)) / m.inertia
    h = left
    after, travel = _slide(v, pull, damping, h)
    stops = after * sign <= 0.0
    sticks = sticks or (stops and v == 0.0)
    if stops and not sticks:
        h = min(max(_time_to_rest(v, pull, damping), 0.0), left)
        after, travel = _slide(v, pull, damping, h)
    return Slide(sticks, stops, h, after, travel, sign, pull, damping, position, speed, torque)
