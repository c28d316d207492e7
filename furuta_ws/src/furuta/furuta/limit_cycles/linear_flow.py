"""Exact motion of a linear loop while its joint sticks, or slides under constant friction.

Between two events such a motion is that of a matrix exponential. Steps only look for the event:
they are as long as a cubic through their ends still describes it, however long the joint waits and
however fast a filter of the loop decays.
"""

import numpy as np

from furuta.limit_cycles.friction_loop import before_event, rate, rest_distance, unbounded
from furuta.limit_cycles.linear_loop import LinearLoop, holding_force
from furuta.limit_cycles.smooth_motion import (
    AT_REST,
    EVENT,
    FURTHER,
    HIGH,
    LOW,
    STUCK,
    TIME_OUT,
    UNBOUNDED,
    traced,
)
from furuta_model.compiled import compiled
from furuta_model.state import PHI_DOT

RESTING = 1e-9  # scaled rate of a joint at rest
SHORTEST_SLIDE = 1e-15  # scaled time: a joint at rest at the limit of its friction only creeps
FIRST_STEP, LONGEST_DRAWN = 1e-3, 0.02
CURVED = 1e-3  # deviation of what ends the motion from the cubic, relative to its size
TERMS = 13  # of the exponential, for matrices of norm 1/2
BISECTIONS = 60
MOST_STEPS = 50_000  # of a slide: one that does not end oscillates for ever


@compiled
def follow_exactly(
    y: np.ndarray,
    mode: float,
    time_limit: float,
    extent: np.ndarray,
    trace: np.ndarray,
    loop: LinearLoop,
) -> tuple[int, float, int]:
    """Follow one piece of motion in place; arguments and result are those of ``follow_piece``."""
    m = _generator(mode, loop)
    x = np.append(y, 1.0)
    t, h, rows, steps = 0.0, FIRST_STEP, 0, 0
    half = _exponential(m, 0.5 * h)
    longest = LONGEST_DRAWN if len(trace) and mode != 0.0 else np.inf
    while t < time_limit and steps < MOST_STEPS:
        steps += 1
        middle = half @ x
        end = half @ middle
        at_start, at_middle, at_end = (
            _observed(x, mode, loop),
            _observed(middle, mode, loop),
            _observed(end, mode, loop),
        )
        slope = _observed_rate(m @ x, mode, loop) - _observed_rate(m @ end, mode, loop)
        cubic = 0.5 * (at_start + at_end) + 0.125 * h * slope
        size = max(abs(at_start), abs(at_middle), abs(at_end))
        curved = abs(cubic - at_middle) > CURVED * size
        if curved and h > FIRST_STEP * 1e-6:
            h *= 0.5
            half = _exponential(m, 0.5 * h)
            continue
        used, ended = h, False
        over_at_middle = before_event(middle[:-1], mode, loop) < 0.0
        if over_at_middle or before_event(end[:-1], mode, loop) < 0.0:
            used = _event(x, 0.5 * h if over_at_middle else h, m, mode, loop)
            end = _exponential(m, used) @ x
            if mode != 0.0:
                end[PHI_DOT] = 0.0
            ended = True
        x = end
        t += used
        for i in range(len(y)):
            y[i] = x[i]
            extent[LOW, i] = min(extent[LOW, i], y[i])
            extent[HIGH, i] = max(extent[HIGH, i], y[i])
        if mode == 0.0:
            extent[FURTHER, STUCK] += used
        rows = traced(t, y, trace, rows)
        if ended:
            creeps = mode != 0.0 and t < SHORTEST_SLIDE
            resting = creeps and rest_distance(y, 0.0, loop) < RESTING
            return AT_REST if resting else EVENT, t, rows
        if unbounded(y, loop):
            return UNBOUNDED, t, rows
        if rest_distance(y, mode, loop) < RESTING:
            return AT_REST, t, rows
        if 2.0 * h < longest:
            h *= 2.0
            half = half @ half
    return TIME_OUT, t, rows


@compiled
def moved_exactly(y: np.ndarray, mode: float, time: float, loop: LinearLoop) -> np.ndarray:
    """The state ``time`` after ``y`` in the piece of motion ``mode``."""
    return (_exponential(_generator(mode, loop), time) @ np.append(y, 1.0))[:-1]


@compiled
def _generator(mode: float, loop: LinearLoop) -> np.ndarray:
    """The matrix (n + 1, n + 1) of the motion: d(y, 1)/dt = M (y, 1)."""
    n = len(loop.b) + 2
    m = np.zeros((n + 1, n + 1))
    unit, constant, column = np.zeros(n), np.zeros(n), np.zeros(n)
    rate(unit, mode, loop, constant)
    for j in range(n):
        unit[j] = 1.0
        rate(unit, mode, loop, column)
        for i in range(n):
            m[i, j] = column[i] - constant[i]
        unit[j] = 0.0
    for i in range(n):
        m[i, n] = constant[i]
    return m


@compiled
def _observed(x: np.ndarray, mode: float, loop: LinearLoop) -> float:
    """What ends the piece of motion at (y, 1): the speed, or the force that holds the joint."""
    return x[PHI_DOT] if mode != 0.0 else holding_force(x[:-1], loop)


@compiled
def _observed_rate(dx: np.ndarray, mode: float, loop: LinearLoop) -> float:
    """Its rate, for the rate of (y, 1)."""
    return _observed(dx, mode, loop) - (0.0 if mode != 0.0 else loop.r[0] / loop.b[0])


@compiled
def _event(x: np.ndarray, high: float, m: np.ndarray, mode: float, loop: LinearLoop) -> float:
    """The time of the first event before ``high``, where the event function is below zero.

    By bisection from a state that comes ever closer to the event.
    """
    low, width, size = 0.0, high, _norm(m)
    for _ in range(BISECTIONS):
        width *= 0.5
        middle = _exponential(m, width) @ x if size * width > 0.5 else _advanced(x, width, m)
        value = before_event(middle[:-1], mode, loop)
        if not (value < 0.0 or (value == 0.0 and low > 0.0)):
            low, x = low + width, middle
        if width <= 1e-16 * (low + width):
            break
    return low + width


@compiled
def _advanced(x: np.ndarray, t: float, m: np.ndarray) -> np.ndarray:
    """e^{Mt} x for a small norm of Mt, by its series."""
    n = len(x)
    result, term, following = x.copy(), x.copy(), np.empty(n)
    for k in range(1, TERMS + 1):
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += m[i, j] * term[j]
            following[i] = total * t / k
        for i in range(n):
            term[i] = following[i]
            result[i] += term[i]
    return result


@compiled
def _norm(m: np.ndarray) -> float:
    """The largest sum of the magnitudes of a column."""
    size = 0.0
    for j in range(len(m)):
        total = 0.0
        for i in range(len(m)):
            total += abs(m[i, j])
        size = max(size, total)
    return size


@compiled
def _exponential(m: np.ndarray, t: float) -> np.ndarray:
    """e^{Mt} by scaling and squaring."""
    n = len(m)
    size = _norm(m) * t
    halvings = 0
    while size > 0.5:
        size *= 0.5
        halvings += 1
    scaled = m * (t / 2.0**halvings)
    result = np.eye(n)
    term = np.eye(n)
    for k in range(1, TERMS + 1):
        term = term @ scaled / k
        result += term
    for _ in range(halvings):
        result = result @ result
    return result
