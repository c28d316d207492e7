"""Periodic motions without a reversal: the joint of a linear loop slows down but never stops.

There is no Poincaré section at v = 0 then. Newton's method finds the state in which the speed falls
through the middle of its range, and the period.
"""

import numpy as np

from furuta.limit_cycles.exact_motion import follow_piece
from furuta.limit_cycles.friction_loop import BRISTLE, rate
from furuta.limit_cycles.linear_loop import LinearLoop
from furuta.limit_cycles.periodic_orbit import (
    DIFFERENCE_STEP,
    MAX_TRACE,
    NEWTON_STEPS,
    TOLERANCE,
    LimitCycle,
)
from furuta.limit_cycles.smooth_motion import CLOSEST, FURTHER, HIGH, LOW, TIME_OUT, extent_at
from furuta_model.state import PHI, PHI_DOT, THETA


def slip_cycle(loop: LinearLoop, y: np.ndarray) -> LimitCycle | None:
    """The periodic motion near ``y``, which slides without a reversal; None if not found."""
    mode = float(np.sign(y[PHI_DOT]))
    moving = slice(PHI_DOT, loop.states if loop.law.bristle else loop.states - 1)
    rows = np.empty((MAX_TRACE, loop.states + 1))
    ended, _, n = follow_piece(y.copy(), mode, loop.longest_return, extent_at(y), rows, loop)
    v = rows[:n, 1 + PHI_DOT]
    middle = 0.5 * (v.min() + v.max())
    falls = np.flatnonzero((v[:-1] > middle) & (v[1:] <= middle))
    if ended != TIME_OUT or len(falls) < 2:
        return None
    period = float(rows[falls[-1], 0] - rows[falls[-2], 0])
    s, size = rows[falls[-1], 1:].copy(), float(np.ptp(v))
    s[PHI] = 0.0
    steps = np.full(len(s[moving]), DIFFERENCE_STEP * size)
    if loop.law.bristle:
        steps[BRISTLE] /= loop.law.parameters.sigma0
    speed = np.empty(loop.states)
    for _ in range(NEWTON_STEPS):
        extent = extent_at(s)
        end = _slid(loop, s, mode, period, extent)
        rate(end, mode, loop, speed)
        columns = []
        for k, step in enumerate(steps):
            ahead, behind = s.copy(), s.copy()
            ahead[PHI_DOT + k] += step
            behind[PHI_DOT + k] -= step
            change = _slid(loop, ahead, mode, period) - _slid(loop, behind, mode, period)
            columns.append(change[moving] / (2.0 * step))
        flow = np.array(columns).T
        if not np.all(np.isfinite(flow)):
            return None
        system = np.column_stack([(flow - np.eye(len(flow)))[:, 1:], speed[moving]])
        correction = np.linalg.lstsq(system, (s - end)[moving], rcond=None)[0]
        if np.linalg.norm(correction) < TOLERANCE * size:
            multipliers = sorted(np.linalg.eigvals(flow), key=lambda m: abs(m - 1.0))[1:]
            return LimitCycle(
                "limit_cycle",
                float(extent[HIGH, PHI] - extent[LOW, PHI]),
                float(extent[HIGH, THETA] - extent[LOW, THETA]),
                period,
                float(end[PHI]) / period,
                0.0,
                tuple(complex(m) for m in sorted(multipliers, key=abs, reverse=True)),
                point=tuple(s),
                rest_distance=float(extent[FURTHER, CLOSEST]),
                side=mode,
                loop=loop,
            )
        s[moving][1:] += correction[:-1]
        period += float(correction[-1])
    return None


def _slid(
    loop: LinearLoop, s: np.ndarray, mode: float, time: float, extent: np.ndarray | None = None
) -> np.ndarray:
    """The state after a slide of ``time`` from ``s``; NaN if it ends before."""
    y = s.copy()
    extent = extent_at(s) if extent is None else extent
    ended, _, _ = follow_piece(y, mode, time, extent, np.empty((0, loop.states + 1)), loop)
    return y if ended == TIME_OUT else np.full(loop.states, np.nan)
