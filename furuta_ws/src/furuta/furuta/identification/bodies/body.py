"""What the fit asks of a body, and slopes by finite differences."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np

from furuta.identification.unknowns import Unknowns, Values

# Step of a first state for finite differences, relative to its spread, and the largest one.
STATE_STEP, LARGEST_STATE_STEP = 1e-3, 1e-5


class Segments(NamedTuple):
    """Recordings in segments: number k has the samples ``bounds[k]`` to ``bounds[k + 1]``.

    ``time`` (n,) [s]; ``measured`` and ``weight`` (n, c): a weight is one over the residual that
    counts as one, or 0 for what was not measured. Segment k belongs to recording ``of[k]``. Its
    state begins near ``first`` (s, k), with the standard deviations ``spread``; 0 if it is known.
    ``data`` is what the body moves along. ``correlated`` samples carry the information of one:
    priors count for so much more against the squares.
    """

    time: np.ndarray
    measured: np.ndarray
    weight: np.ndarray
    bounds: np.ndarray
    of: np.ndarray
    first: np.ndarray
    spread: np.ndarray
    data: Any
    correlated: float = 1.0

    @property
    def lengths(self) -> np.ndarray:
        """Samples of each segment (s,)."""
        return np.diff(self.bounds)

    @property
    def noise(self) -> float:
        """Residual of a position, the first channel, that counts as one."""
        return float(1.0 / self.weight[0, 0])

    def with_noise(self, factor: float, correlated: float) -> Segments:
        """With a noise that is larger by a factor, and first states that are as uncertain."""
        weight, spread = self.weight / factor, self.spread * factor
        return self._replace(weight=weight, spread=spread, correlated=correlated)

    def chosen(self, which: np.ndarray) -> Segments:
        """Some of the segments."""
        rows = np.concatenate([np.arange(self.bounds[k], self.bounds[k + 1]) for k in which])
        return self._replace(
            time=self.time[rows],
            measured=self.measured[rows],
            weight=self.weight[rows],
            bounds=np.cumsum(np.append(0, self.lengths[which])),
            of=self.of[which],
            first=self.first[which],
            spread=self.spread[which],
        )


class Body(Protocol):
    """How outputs follow from values and first states.

    ``speed`` is the number of the state that is searched where a segment is badly explained: near
    rest, residuals are no smooth function of it. None for no search.
    """

    speed: int | None

    def outputs(self, values: Values, first: np.ndarray, cut: Segments) -> np.ndarray:
        """What is predicted for each sample (n, c)."""

    def slopes(
        self, values: Values, first: np.ndarray, cut: Segments, unknowns: Unknowns
    ) -> tuple[np.ndarray, np.ndarray]:
        """Slopes of the outputs in the unknowns (n, c, p) and in the segments' states (n, c, k)."""


class Differentiated:
    """A body whose slopes are finite differences; all segments change at once."""

    speed: int | None = None

    def outputs(self, values: Values, first: np.ndarray, cut: Segments) -> np.ndarray:
        """What is predicted for each sample (n, c)."""
        raise NotImplementedError

    def slopes(
        self, values: Values, first: np.ndarray, cut: Segments, unknowns: Unknowns
    ) -> tuple[np.ndarray, np.ndarray]:
        """Slopes of the outputs in the unknowns (n, c, p) and in the segments' states (n, c, k)."""
        base, vector = self.outputs(values, first, cut), unknowns.vector(values)
        columns = np.empty((*base.shape, len(unknowns)))
        sizes = np.maximum(unknowns.all("size"), np.abs(vector))
        for j, step in enumerate(unknowns.all("step") * sizes):
            there = unknowns.changed(values, vector + step * (np.arange(len(vector)) == j))
            columns[:, :, j] = (self.outputs(there, first, cut) - base) / step
        states = np.zeros((*base.shape, first.shape[1]))
        for k in range(first.shape[1]):
            if step := min(STATE_STEP * float(cut.spread[:, k].max()), LARGEST_STATE_STEP):
                moved = first + step * (np.arange(first.shape[1]) == k)
                states[:, :, k] = (self.outputs(values, moved, cut) - base) / step
        return columns, states
