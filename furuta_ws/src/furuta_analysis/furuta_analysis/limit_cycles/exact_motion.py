"""The ideal loop's motion, integrated accurately through stick and slip.

Each piece of motion is integrated by the Dormand–Prince pair 5(4) with error control and ends
exactly at its event.
"""

from __future__ import annotations

from math import isfinite, pi
from typing import NamedTuple

import numpy as np

from furuta_analysis.limit_cycles.ideal_loop import (
    IdealLoop,
    before_event,
    least_travel,
    next_mode,
    rate,
)
from furuta_analysis.simulation.oscillation import STUCK_SPEED
from furuta_model.compiled import compiled
from furuta_model.friction.laws import has_bristle
from furuta_model.state import PHI, PHI_DOT, PLANT_STATES, THETA, THETA_DOT

# How a piece of motion ended.
TURNED = 0  # v came to 0
TIME_OUT = 1
UNBOUNDED = 2  # the pendulum fell, or the state grew beyond all bounds
TOO_STIFF = 3  # the bristle is too fast for steps of any use
MOST_STEPS = 1_000_000  # of one piece of motion
HIGHEST_SPEED = 1e3
AT_REST = 1e-8  # |θ| [rad] and |θ̇| [rad/s] together
LONGEST_STEP = 5e-3
SHORTEST_STEP = 1e-12
RELATIVE_TOLERANCE = 1e-9
ABSOLUTE_TOLERANCE = 1e-11


class Extent(NamedTuple):
    """Index of what :func:`slide` keeps account of, in an array (5,)."""

    PHI_LOW: int = 0
    PHI_HIGH: int = 1
    THETA_LOW: int = 2
    THETA_HIGH: int = 3
    STUCK: int = 4


PHI_LOW, PHI_HIGH, THETA_LOW, THETA_HIGH, STUCK = Extent()


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
    if mode == 0.0 or (has_bristle(loop.law) and resting):
        extent[STUCK] += h


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
