"""Integrates the motion of a loop accurately through stick, slip and rests.

The motion consists of smooth pieces (:mod:`.smooth_motion`, :mod:`.linear_flow`). Where the
pendulum comes close to a rest, it is followed in coordinates counted from that rest, with
tolerances in proportion to the distance: how long the arm stays at an unstable rest depends on how
close it comes, however close that is.
"""

import numpy as np

from furuta.limit_cycles.friction_loop import FrictionLoop, by_type, next_mode
from furuta.limit_cycles.linear_flow import follow_exactly, moved_exactly
from furuta.limit_cycles.linear_loop import LinearLoop
from furuta.limit_cycles.pendulum_loop import IdealLoop, rest_near
from furuta.limit_cycles.smooth_motion import (
    AT_REST,
    EVENT,
    FURTHER,
    HIGH,
    LEFT_REST,
    LOW,
    NEAR_REST,
    OTHER_SIDE,
    REACHED,
    ROUNDING,
    STEPS,
    extent_at,
    integrate,
)
from furuta_model.compiled import compiled
from furuta_model.friction.laws import COULOMB, STICTION
from furuta_model.state import BRISTLE, PHI

LONGEST_SLIDE = 1000.0  # scaled time that an integration takes for one without end
MOST_REVERSALS = 32  # of one side that a period has, and that come without one of the other side


@compiled
def _follow_pendulum(
    y: np.ndarray,
    mode: float,
    time_limit: float,
    extent: np.ndarray,
    trace: np.ndarray,
    loop: IdealLoop,
) -> tuple[int, float, int]:
    t, rows = 0.0, 0
    while True:
        ended, duration, more = integrate(y, mode, time_limit - t, loop, 0.0, extent, trace[rows:])
        _delay(trace, rows, more, t)
        t, rows = t + duration, rows + more
        if ended != NEAR_REST:
            return ended, t, rows
        ended, duration, more = _follow_near_rest(
            y, mode, time_limit - t, loop, extent, trace[rows:]
        )
        _delay(trace, rows, more, t)
        t, rows = t + duration, rows + more
        if ended != LEFT_REST:
            return ended, t, rows


@compiled
def _follow_linear(
    y: np.ndarray,
    mode: float,
    time_limit: float,
    extent: np.ndarray,
    trace: np.ndarray,
    loop: LinearLoop,
) -> tuple[int, float, int]:
    if mode == 0.0 or loop.law.kind in (COULOMB, STICTION):
        return follow_exactly(y, mode, time_limit, extent, trace, loop)
    limit = min(time_limit, LONGEST_SLIDE)
    reached = 0.0
    t, rows = 0.0, 0
    while True:
        ended, duration, more = integrate(y, mode, limit - t, loop, reached, extent, trace[rows:])
        _delay(trace, rows, more, t)
        t, rows = t + duration, rows + more
        if ended == NEAR_REST and loop.passes_rests:
            reached = ROUNDING
        elif ended == LEFT_REST:
            reached = 0.0
        else:
            return AT_REST if ended == NEAR_REST else ended, t, rows


def state_after(y: np.ndarray, mode: float, time: float, loop: LinearLoop) -> np.ndarray:
    """The state ``time`` after ``y`` in the piece of motion ``mode``, which does not end before."""
    if mode == 0.0 or loop.law.kind in (COULOMB, STICTION):
        return moved_exactly(y, mode, time, loop)
    y = y.copy()
    integrate(y, mode, time, loop, 0.0, extent_at(y), np.empty((0, len(y) + 1)))
    return y


# ``follow_piece(y, mode, time_limit, extent, trace, loop)`` follows one piece of motion from ``y``,
# in place, to its event or for ``time_limit`` [s]. ``extent`` is updated. ``trace`` (n, 1 + states)
# gets time and state of every step, up to n rows. Returns how the piece ended, its duration [s] and
# the number of rows written.
follow_piece = by_type({IdealLoop: _follow_pendulum, LinearLoop: _follow_linear})


@compiled
def _delay(trace: np.ndarray, first: int, rows: int, t: float) -> None:
    for row in range(first, first + rows):
        trace[row, 0] += t


@compiled
def _follow_near_rest(
    y: np.ndarray,
    mode: float,
    time_limit: float,
    loop: IdealLoop,
    extent: np.ndarray,
    trace: np.ndarray,
) -> tuple[int, float, int]:
    """Continue a piece of motion in coordinates counted from the rest near ``y``."""
    phi, held = rest_near(y, mode, loop)
    z = held / loop.law.parameters.sigma0 if loop.law.bristle else 0.0
    local = IdealLoop(loop.body, loop.law, loop.l1, loop.l2, loop.l3, loop.l4, loop.linear, held)
    _shift(y, extent, -phi, -z)
    ended, duration, rows = integrate(y, mode, time_limit, local, REACHED, extent, trace)
    _shift(y, extent, phi, z)
    for row in range(rows):
        trace[row, 1 + PHI] += phi
        trace[row, 1 + BRISTLE] += z
    return ended, duration, rows


@compiled
def _shift(y: np.ndarray, extent: np.ndarray, phi: float, z: float) -> None:
    y[PHI] += phi
    y[BRISTLE] += z
    extent[LOW, PHI] += phi
    extent[HIGH, PHI] += phi
    extent[LOW, BRISTLE] += z
    extent[HIGH, BRISTLE] += z


@compiled
def follow_to_reversal(
    y: np.ndarray,
    mode: float,
    time_limit: float,
    loop: FrictionLoop,
    side: float,
    smallest: float,
    extent: np.ndarray,
    trace: np.ndarray,
) -> tuple[int, float, int]:
    """Follow the motion until the arm stops moving in the direction ``side`` (±1).

    A reversal counts only after a slide of ``smallest`` [rad], because the stuck arm oscillates on
    a stiff bristle. ``mode`` is the piece that begins at ``y``. Returns the same as
    :func:`follow_piece`; after EVENT the next piece is ``next_mode(y, side, loop)``. OTHER_SIDE
    ends a motion that only reverses after slides in the other direction, at such a reversal: where
    friction or a reference drives it in one direction, it never slides in the other.
    """
    t, rows, others = 0.0, 0, 0
    while True:
        start = y[PHI]
        ended, duration, more = follow_piece(y, mode, time_limit - t, extent, trace[rows:], loop)
        _delay(trace, rows, more, t)
        t += duration
        rows += more
        if ended != EVENT:
            return ended, t, rows
        if mode * (y[PHI] - start) >= smallest and mode != 0.0:
            if mode == side:
                return EVENT, t, rows
            others += 1
            extent[FURTHER, STEPS] = 0.0
            if others == MOST_REVERSALS:
                return OTHER_SIDE, t, rows
        mode = next_mode(y, mode, loop)
