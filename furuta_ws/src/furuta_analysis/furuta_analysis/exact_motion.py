r"""The ideal loop, u = l·x without sampling, integrated accurately through stick and slip.

Between two events the motion is smooth: the arm slides in one direction (v > 0 or v < 0) or, under
a stick-slip law, stands still while the pendulum goes on with β θ̈ = δ sin θ. Each piece is
integrated by the Dormand–Prince pair 5(4) with error control; an event ends it exactly where it
happens: v = 0 while sliding, or the holding force

.. math::
    F_{hold} = u - γ\cosθ\,\frac{δ}{β}\sinθ + γ\sinθ\,\dot θ^2

reaching the breakaway level while at rest. LuGre never rests; its pieces end at v = 0, where |v|
has its kink.
"""

from __future__ import annotations

from math import cos, isfinite, pi, sin
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.friction_laws import LUGRE, FrictionLaw, breakaway_level, sliding_level
from furuta_model.lugre import highest_level
from furuta_model.pendulum import FurutaPendulum, accelerations
from furuta_model.state import BRISTLE, PHI, PHI_DOT, PLANT_STATES, THETA, THETA_DOT

# How a piece of motion ended.
TURNED = 0  # v came to 0
TIME_OUT = 1
UNBOUNDED = 2  # the pendulum fell, or the state grew beyond all bounds
TOO_STIFF = 3  # the bristle is too fast for steps of any use
MOST_STEPS = 1_000_000  # of one piece of motion
# Stuck is what LuGre creeps through: below this arm speed [rad/s].
STUCK_SPEED = 1e-2
HIGHEST_SPEED = 1e3
AT_REST = 1e-8  # |θ| [rad] and |θ̇| [rad/s] together
LONGEST_STEP = 5e-3
SHORTEST_STEP = 1e-12
RELATIVE_TOLERANCE = 1e-9
ABSOLUTE_TOLERANCE = 1e-11


class IdealLoop(NamedTuple):
    """Pendulum (nonlinear, or linear about upright), friction law and feedback u = l·x."""

    body: FurutaPendulum
    law: FrictionLaw
    l1: float
    l2: float
    l3: float
    l4: float
    linear: bool = False


class Extent(NamedTuple):
    """Index of what :func:`slide` keeps account of, in an array (5,)."""

    PHI_LOW: int = 0
    PHI_HIGH: int = 1
    THETA_LOW: int = 2
    THETA_HIGH: int = 3
    STUCK: int = 4


PHI_LOW, PHI_HIGH, THETA_LOW, THETA_HIGH, STUCK = Extent()


@compiled
def feedback(y: np.ndarray, loop: IdealLoop) -> float:
    """U = l·x [V]."""
    return loop.l1 * y[PHI] + loop.l2 * y[PHI_DOT] + loop.l3 * y[THETA] + loop.l4 * y[THETA_DOT]


@compiled
def body_accelerations(y: np.ndarray, torque: float, loop: IdealLoop) -> tuple[float, float]:
    """(φ̈, θ̈) [rad/s²] of the nonlinear or linear body under torque u − F [V]."""
    p = loop.body
    if not loop.linear:
        return accelerations(y[PHI_DOT], y[THETA], y[THETA_DOT], torque, p)
    d = p.alpha * p.beta - p.gamma * p.gamma
    gravity = p.delta * y[THETA]
    return (p.beta * torque - p.gamma * gravity) / d, (p.alpha * gravity - p.gamma * torque) / d


@compiled
def holding_force(y: np.ndarray, loop: IdealLoop) -> float:
    """Friction [V] that keeps the arm at rest."""
    p = loop.body
    theta, w = y[THETA], y[THETA_DOT]
    if loop.linear:
        return feedback(y, loop) - p.gamma * p.delta / p.beta * theta
    pull = p.gamma * cos(theta) * p.delta / p.beta * sin(theta) - p.gamma * sin(theta) * w * w
    return feedback(y, loop) - pull


@compiled
def rate(y: np.ndarray, mode: float, loop: IdealLoop, dy: np.ndarray) -> None:
    """ẏ (5,) while sliding in direction ``mode`` (±1) or resting (0)."""
    p = loop.law.parameters
    v = y[PHI_DOT]
    dy[PHI], dy[THETA], dy[BRISTLE] = v, y[THETA_DOT], 0.0
    if mode == 0.0:
        sine = y[THETA] if loop.linear else sin(y[THETA])
        dy[PHI], dy[PHI_DOT] = 0.0, 0.0
        dy[THETA_DOT] = loop.body.delta / loop.body.beta * sine
        return
    level = sliding_level(v, mode, loop.law)
    if loop.law.kind == LUGRE:
        z = y[BRISTLE]
        dy[BRISTLE] = v - p.sigma0 * mode * v / max(level, 1e-12) * z
        force = p.sigma0 * z + p.sigma1 * dy[BRISTLE]
    else:
        force = mode * level
    torque = feedback(y, loop) - force - p.viscous * v
    dy[PHI_DOT], dy[THETA_DOT] = body_accelerations(y, torque, loop)


@compiled
def step(
    y: np.ndarray, h: float, mode: float, loop: IdealLoop, k: np.ndarray, end: np.ndarray
) -> float:
    """One Dormand–Prince step of ``h`` [s] from ``y`` to ``end``; returns the scaled error.

    ``k`` (7, 5) is work space whose row 0 holds the rate at ``y``; row 6 becomes that at ``end``.
    """
    n = len(y)
    for i in range(n):
        end[i] = y[i] + h * (1 / 5) * k[0, i]
    rate(end, mode, loop, k[1])
    for i in range(n):
        end[i] = y[i] + h * (3 / 40 * k[0, i] + 9 / 40 * k[1, i])
    rate(end, mode, loop, k[2])
    for i in range(n):
        end[i] = y[i] + h * (44 / 45 * k[0, i] - 56 / 15 * k[1, i] + 32 / 9 * k[2, i])
    rate(end, mode, loop, k[3])
    for i in range(n):
        end[i] = y[i] + h * (
            19372 / 6561 * k[0, i]
            - 25360 / 2187 * k[1, i]
            + 64448 / 6561 * k[2, i]
            - 212 / 729 * k[3, i]
        )
    rate(end, mode, loop, k[4])
    for i in range(n):
        end[i] = y[i] + h * (
            9017 / 3168 * k[0, i]
            - 355 / 33 * k[1, i]
            + 46732 / 5247 * k[2, i]
            + 49 / 176 * k[3, i]
            - 5103 / 18656 * k[4, i]
        )
    rate(end, mode, loop, k[5])
    for i in range(n):
        end[i] = y[i] + h * (
            35 / 384 * k[0, i]
            + 500 / 1113 * k[2, i]
            + 125 / 192 * k[3, i]
            - 2187 / 6784 * k[4, i]
            + 11 / 84 * k[5, i]
        )
    rate(end, mode, loop, k[6])
    worst = 0.0
    for i in range(n):
        error = h * (
            71 / 57600 * k[0, i]
            - 71 / 16695 * k[2, i]
            + 71 / 1920 * k[3, i]
            - 17253 / 339200 * k[4, i]
            + 22 / 525 * k[5, i]
            - 1 / 40 * k[6, i]
        )
        scale = ABSOLUTE_TOLERANCE + RELATIVE_TOLERANCE * max(abs(y[i]), abs(end[i]))
        worst = max(worst, abs(error) / scale)
    return worst


@compiled
def friction_at(y: np.ndarray, loop: IdealLoop) -> float:
    """Friction [V] in state ``y`` (5,): of the slide, or what holds the resting arm."""
    p = loop.law.parameters
    v = y[PHI_DOT]
    if v == 0.0 and loop.law.kind != LUGRE:
        return holding_force(y, loop)
    mode = 1.0 if v >= 0.0 else -1.0
    level = sliding_level(v, mode, loop.law)
    if loop.law.kind == LUGRE:
        z = y[BRISTLE]
        z_dot = v - p.sigma0 * abs(v) / max(level, 1e-12) * z
        return p.sigma0 * z + p.sigma1 * z_dot + p.viscous * v
    return mode * level + p.viscous * v


@compiled
def before_event(y: np.ndarray, mode: float, loop: IdealLoop) -> float:
    """Positive inside the piece of motion ``mode``, zero at the event that ends it."""
    if mode != 0.0:
        return mode * y[PHI_DOT]
    hold = holding_force(y, loop)
    return min(breakaway_level(1.0, loop.law) - hold, breakaway_level(-1.0, loop.law) + hold)


@compiled
def next_mode(y: np.ndarray, mode: float, loop: IdealLoop) -> float:
    """The piece of motion that follows an event at ``y``."""
    if loop.law.kind == LUGRE:
        return -mode
    hold = holding_force(y, loop)
    if mode != 0.0 and -breakaway_level(-1.0, loop.law) <= hold <= breakaway_level(1.0, loop.law):
        return 0.0
    return 1.0 if hold > 0.0 else -1.0


@compiled
def slide(
    y: np.ndarray,
    mode: float,
    longest: float,
    loop: IdealLoop,
    extent: np.ndarray,
    trace: np.ndarray,
) -> tuple[int, float, int]:
    """Follow one piece of motion from ``y``, in place, to its event or for ``longest`` [s].

    ``extent`` is widened, ``trace`` (n, 6) gets time and state of every step while it has room.
    Returns how it ended, its duration [s] and the number of rows written.
    """
    k = np.empty((7, PLANT_STATES))
    end = np.empty(PLANT_STATES)
    t, h, rows, steps = 0.0, 1e-4, 0, 0
    rate(y, mode, loop, k[0])
    while t < longest:
        steps += 1
        if steps > MOST_STEPS:
            return TOO_STIFF, t, rows
        h = min(h, LONGEST_STEP, longest - t)
        error = step(y, h, mode, loop, k, end)
        if not isfinite(error):
            return UNBOUNDED, t, rows
        if error > 1.0 and h > SHORTEST_STEP:
            h *= max(0.2, 0.9 * error**-0.2)
            continue
        ended = before_event(end, mode, loop) < 0.0
        used = h
        if ended:
            used = _locate(y, h, mode, loop, k, end)
            if mode != 0.0:
                end[PHI_DOT] = 0.0
        _account(y, end, used, mode, loop, extent)
        t += used
        y[:] = end
        if rows < len(trace):
            trace[rows, 0] = t
            trace[rows, 1:] = y
            rows += 1
        if ended:
            return TURNED, t, rows
        if abs(y[THETA]) > 0.5 * pi or abs(y[PHI_DOT]) > HIGHEST_SPEED:
            return UNBOUNDED, t, rows
        k[0] = k[6]
        h *= min(5.0, 0.9 * max(error, 1e-10) ** -0.2)
    return TIME_OUT, t, rows


@compiled
def _locate(
    y: np.ndarray, h: float, mode: float, loop: IdealLoop, k: np.ndarray, end: np.ndarray
) -> float:
    """The step [s] from ``y`` after which the event happens, ``end`` the state there.

    Illinois false position on the step's own length: each trial is a full step of fifth order.
    """
    low, high = 0.0, h
    at_low, at_high = max(before_event(y, mode, loop), 0.0), before_event(end, mode, loop)
    if at_low == 0.0:  # the piece began at v = 0: look for a point inside it
        low = 1e-3 * h
        step(y, low, mode, loop, k, end)
        at_low = before_event(end, mode, loop)
        if at_low <= 0.0:
            return low
    middle = high
    for _ in range(60):
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        step(y, middle, mode, loop, k, end)
        value = before_event(end, mode, loop)
        if abs(value) < 1e-14 or high - low < 1e-15:
            break
        if value < 0.0:
            high, at_high = middle, value
            at_low *= 0.5
        else:
            low, at_low = middle, value
            at_high *= 0.5
    return middle


@compiled
def _account(
    y: np.ndarray, end: np.ndarray, h: float, mode: float, loop: IdealLoop, extent: np.ndarray
) -> None:
    """Widen the extent by one step; an extreme of θ inside it is found on the cubic through it."""
    extent[PHI_LOW] = min(extent[PHI_LOW], end[PHI])
    extent[PHI_HIGH] = max(extent[PHI_HIGH], end[PHI])
    theta = end[THETA]
    w0, w1 = y[THETA_DOT], end[THETA_DOT]
    if w0 * w1 < 0.0:
        s = w0 / (w0 - w1)
        theta = (
            (1 + 2 * s) * (1 - s) ** 2 * y[THETA]
            + s * (1 - s) ** 2 * h * w0
            + s * s * (3 - 2 * s) * end[THETA]
            + s * s * (s - 1) * h * w1
        )
    extent[THETA_LOW] = min(extent[THETA_LOW], theta, end[THETA])
    extent[THETA_HIGH] = max(extent[THETA_HIGH], theta, end[THETA])
    resting = abs(y[PHI_DOT]) < STUCK_SPEED and abs(end[PHI_DOT]) < STUCK_SPEED
    if mode == 0.0 or (loop.law.kind == LUGRE and resting):
        extent[STUCK] += h


@compiled
def least_travel(loop: IdealLoop) -> float:
    """How far [rad] the arm must go for a slide: the whole deflection of LuGre's bristle."""
    if loop.law.kind != LUGRE:
        return 0.0
    return 2.0 * highest_level(loop.law.parameters) / loop.law.parameters.sigma0


@compiled
def to_upper_turn(
    y: np.ndarray,
    mode: float,
    longest: float,
    loop: IdealLoop,
    extent: np.ndarray,
    trace: np.ndarray,
) -> tuple[int, float, int]:
    """Follow the motion through its pieces until the arm turns from forward (v = 0 from above).

    A turn counts only after a slide: a stiff bristle rings while the arm is stuck on it.
    ``mode`` is the piece that begins at ``y``. Returns as :func:`slide` does; after TURNED the
    next piece is ``next_mode(y, 1.0, loop)``.
    """
    t, rows = 0.0, 0
    least = least_travel(loop)
    while True:
        began_at = y[PHI]
        ended, took, more = slide(y, mode, longest - t, loop, extent, trace[rows:])
        for row in range(rows, rows + more):
            trace[row, 0] += t
        t += took
        rows += more
        if ended != TURNED:
            return ended, t, rows
        if mode == 1.0 and y[PHI] - began_at >= least:
            return TURNED, t, rows
        if abs(y[THETA]) + abs(y[THETA_DOT]) < AT_REST:
            return TIME_OUT, t, rows
        mode = next_mode(y, mode, loop)
