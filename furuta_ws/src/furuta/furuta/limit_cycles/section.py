"""Poincaré map of a loop with friction.

The section is the joint's upper reversal, v = 0 from above. There the state has n free coordinates:
all but v, without the bristle where there is none, and without a position on which nothing depends.
The map P leads from one upper reversal to the next.
"""

from typing import NamedTuple

import numpy as np

from furuta.limit_cycles.exact_motion import follow_to_upper_reversal
from furuta.limit_cycles.friction_loop import BRISTLE, FrictionLoop, next_mode, smallest_slide
from furuta.limit_cycles.smooth_motion import CLOSEST, EVENT, FURTHER, extent_at

DIFFERENCE_STEP = 1e-6  # of the finite differences, relative to the size of the cycle
# Limit of that step, relative to the least distance from a rest, to stay on one side of it.
REST_STEP = 1e-2


class Return(NamedTuple):
    """One application of the map: end state (n,), time [s], extent (3, n), how it ended."""

    y: np.ndarray
    time: float
    extent: np.ndarray
    ended: int


class Section:
    """The Poincaré map of a loop in its free coordinates.

    A reversal counts only after a slide of ``smallest`` [rad].
    """

    def __init__(self, loop: FrictionLoop, smallest: float | None = None) -> None:
        self.loop = loop
        self.smallest = smallest_slide(loop) if smallest is None else smallest
        self.free = loop.free
        self._no_trace = np.empty((0, loop.states + 1))

    def state(self, s: np.ndarray) -> np.ndarray:
        """State of section coordinates."""
        y = np.zeros(self.loop.states)
        y[self.free] = s
        return y

    def follow(self, y: np.ndarray, mode: float | None = None, turns: int = 1) -> Return:
        """Follow the motion to the ``turns``-th upper reversal.

        ``mode`` is the piece of motion that begins at ``y``; None if ``y`` is an upper reversal.
        """
        y = y.copy()
        extent = extent_at(y)
        time = 0.0
        for _ in range(turns):
            first = next_mode(y, 1.0, self.loop) if mode is None else mode
            mode = None
            ended, duration, _ = follow_to_upper_reversal(
                y, first, self.loop.longest_return, self.loop, self.smallest, extent, self._no_trace
            )
            time += duration
            if ended != EVENT:
                return Return(y, time, extent, ended)
        return Return(y, time, extent, EVENT)

    def map(self, s: np.ndarray, turns: int) -> np.ndarray | None:
        """P(s) applied ``turns`` times, or None if the motion does not return."""
        end = self.follow(self.state(s), turns=turns)
        return end.y[self.free] if end.ended == EVENT else None

    def jacobian(self, s: np.ndarray, turns: int, size: float) -> np.ndarray | None:
        """dP/ds by central differences, or None if the motion does not return."""
        closest = float(self.follow(self.state(s), turns=turns).extent[FURTHER, CLOSEST])
        step = min(DIFFERENCE_STEP * size, REST_STEP * closest)
        columns = []
        for i in range(len(s)):
            # The deflection of the bristle is a torque divided by σ₀.
            scale = (
                self.loop.law.parameters.sigma0
                if self.free[i] == len(self.state(s)) + BRISTLE
                else 1.0
            )
            d = np.zeros_like(s)
            d[i] = step / scale
            ahead, behind = self.map(s + d, turns), self.map(s - d, turns)
            if ahead is None or behind is None:
                return None
            columns.append((ahead - behind) / (2 * d[i]))
        return np.array(columns).T
