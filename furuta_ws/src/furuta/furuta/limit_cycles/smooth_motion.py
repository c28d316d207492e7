"""Integrates one smooth piece of motion of a loop with friction to its event.

The Dormand–Prince pair 5(4) with error control ends exactly at the event: a reversal (v = 0) or the
breakaway of the stuck arm.
"""

from math import inf, isfinite

import numpy as np

from furuta.limit_cycles.friction_loop import (
    FrictionLoop,
    before_event,
    longest_step,
    rate,
    rest_distance,
    unbounded,
)
from furuta.oscillation import STUCK_SPEED
from furuta_model.compiled import compiled
from furuta_model.state import PHI_DOT

# How a piece of motion ended.
GOES_ON = -1
EVENT = 0  # at its event
TIME_OUT = 1
UNBOUNDED = 2  # the pendulum fell, or the state grew without bound
TOO_STIFF = 3  # the bristle is too fast: the steps become too small
AT_REST = 4  # closer to a rest than any disturbance
NEAR_REST = 5  # within the distance from which a rest is the origin
LEFT_REST = 6  # no longer so
OTHER_SIDE = 7  # the motion reverses on the other side only
MAX_STEPS = 1_000_000  # of one extent
# Distances from a rest: where it becomes and ceases to be the origin, and where it is reached.
# Disturbances of the last size decide how long the arm stays at an unstable rest. Of a state that
# is not counted from the rest, rounding is larger.
NEAR, FAR, REACHED, ROUNDING = 1e-6, 1e-5, 1e-14, 1e-11
MIN_STEP = 1e-12  # [s]
RELATIVE_TOLERANCE = 1e-9
ABSOLUTE_TOLERANCE = 1e-11
SLOWING = 0.5  # largest change of the speed in a step, relative to it and the Stribeck velocity


# Rows of an extent (3, n): extremes of each state, and in the last one further numbers:
LOW, HIGH, FURTHER = range(3)
STUCK, CLOSEST, STEPS = range(3)  # time stuck [s], least distance from a rest, steps


def extent_at(y: np.ndarray) -> np.ndarray:
    """The extent of a motion that begins at ``y`` (n,)."""
    further = np.zeros(len(y))
    further[CLOSEST] = np.inf
    return np.array([y, y, further])


@compiled
def traced(t: float, y: np.ndarray, trace: np.ndarray, rows: int) -> int:
    """Add time and state to the trace if it has a row left; return the number of rows in use."""
    if rows == len(trace):
        return rows
    # By elements: numba compiles an assignment of rows for seconds.
    trace[rows, 0] = t
    for i in range(len(y)):
        trace[rows, 1 + i] = y[i]
    return rows + 1


@compiled
def integrate(
    y: np.ndarray,
    mode: float,
    time_limit: float,
    loop: FrictionLoop,
    reached: float,
    extent: np.ndarray,
    trace: np.ndarray,
) -> tuple[int, float, int]:
    """Follow a piece of motion in place while it stays away from rests, or near one.

    ``reached``: distance at which the rest is reached that is near; 0 if none is. Returns the same
    as :func:`furuta.limit_cycles.exact_motion.follow_piece`.
    """
    k = np.empty((7, len(y)))
    end = np.empty(len(y))
    t, h, rows = 0.0, 1e-4, 0
    size = rest_distance(y, mode, loop) if reached > 0.0 else 1.0
    rate(y, mode, loop, k[0])
    while t < time_limit:
        extent[FURTHER, STEPS] += 1.0
        if extent[FURTHER, STEPS] > MAX_STEPS:
            return TOO_STIFF, t, rows
        h = min(h, longest_step(mode, loop), _slowing(y, k[0], mode, loop), time_limit - t)
        error = step(y, h, mode, loop, size, k, end)
        if not error <= 1.0:
            if h <= MIN_STEP:
                return TOO_STIFF, t, rows
            h *= max(0.2, 0.9 * error**-0.2)
            continue
        ended = before_event(end, mode, loop) < 0.0
        used = h
        if ended:
            used = _locate(y, h, mode, loop, size, k, end)
            if mode != 0.0:
                end[PHI_DOT] = 0.0
        _update_extent(y, end, used, k, mode, loop, extent)
        t += used
        for i in range(len(y)):
            y[i] = end[i]
        rows = traced(t, y, trace, rows)
        distance = rest_distance(y, mode, loop)
        extent[FURTHER, CLOSEST] = min(extent[FURTHER, CLOSEST], distance)
        if ended:
            return EVENT, t, rows
        ending = _ending(y, reached, distance, loop)
        if ending != GOES_ON:
            return ending, t, rows
        size = distance if reached > 0.0 else 1.0
        k[0] = k[6]
        h *= min(5.0, 0.9 * max(error, 1e-10) ** -0.2)
    return TIME_OUT, t, rows


@compiled
def _slowing(y: np.ndarray, dy: np.ndarray, mode: float, loop: FrictionLoop) -> float:
    """Longest step that does not pass over speeds at which the level changes."""
    p = loop.law.parameters
    if mode == 0.0 or p.stribeck_velocity == 0.0 or dy[PHI_DOT] == 0.0:
        return np.inf
    return SLOWING * (abs(y[PHI_DOT]) + p.stribeck_velocity) / abs(dy[PHI_DOT])


@compiled
def _ending(y: np.ndarray, reached: float, distance: float, loop: FrictionLoop) -> int:
    """How the piece of motion ends at ``y``, ``distance`` from a rest; GOES_ON if it does not."""
    if unbounded(y, loop):
        return UNBOUNDED
    if reached == 0.0:
        return NEAR_REST if distance < NEAR else GOES_ON
    if distance < reached:
        return AT_REST
    return LEFT_REST if distance > FAR else GOES_ON


@compiled
def _locate(
    y: np.ndarray,
    h: float,
    mode: float,
    loop: FrictionLoop,
    size: float,
    k: np.ndarray,
    end: np.ndarray,
) -> float:
    """Find the step [s] from ``y`` to the event; ``end`` becomes the state there.

    Uses the Illinois method on the length of the step; each trial is a full step of fifth order.
    """
    low, high = 0.0, h
    at_low, at_high = max(before_event(y, mode, loop), 0.0), before_event(end, mode, loop)
    if at_low == 0.0:  # the piece began at v = 0: start from a point inside it
        low = 1e-3 * h
        step(y, low, mode, loop, size, k, end)
        at_low = before_event(end, mode, loop)
        if at_low <= 0.0:
            return low
    middle = high
    for _ in range(60):
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        step(y, middle, mode, loop, size, k, end)
        value = before_event(end, mode, loop)
        if abs(value) < 1e-14 * size or high - low < 1e-15:
            break
        if value < 0.0:
            high, at_high = middle, value
            at_low *= 0.5
        else:
            low, at_low = middle, value
            at_high *= 0.5
    return middle


@compiled
def _update_extent(
    y: np.ndarray,
    end: np.ndarray,
    h: float,
    k: np.ndarray,
    mode: float,
    loop: FrictionLoop,
    extent: np.ndarray,
) -> None:
    """Include one step; an extreme inside it is found on the cubic interpolation of its state."""
    for i in range(len(y)):
        value = end[i]
        at_start, at_end = k[0, i], k[6, i]
        if at_start * at_end < 0.0:
            s = at_start / (at_start - at_end)
            value = (
                (1 + 2 * s) * (1 - s) ** 2 * y[i]
                + s * (1 - s) ** 2 * h * at_start
                + s * s * (3 - 2 * s) * end[i]
                + s * s * (s - 1) * h * at_end
            )
        extent[LOW, i] = min(extent[LOW, i], value, end[i])
        extent[HIGH, i] = max(extent[HIGH, i], value, end[i])
    stuck = abs(y[PHI_DOT]) < STUCK_SPEED and abs(end[PHI_DOT]) < STUCK_SPEED
    if mode == 0.0 or (loop.law.bristle and stuck):
        extent[FURTHER, STUCK] += h


@compiled
def step(
    y: np.ndarray,
    h: float,
    mode: float,
    loop: FrictionLoop,
    size: float,
    k: np.ndarray,
    end: np.ndarray,
) -> float:
    """One step of ``h`` [s] from ``y`` to ``end``; returns the error, at most 1 within tolerance.

    ``size`` is that of a small motion, in proportion to which the absolute tolerance is reduced.
    ``k`` (7, n) is work space. Row 0 must hold the rate at ``y``; row 6 gets the rate at ``end``.
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
        scale = size * ABSOLUTE_TOLERANCE + RELATIVE_TOLERANCE * max(abs(y[i]), abs(end[i]))
        if not isfinite(error):  # the maximum would lose it
            return inf
        worst = max(worst, abs(error) / scale)
    return worst
