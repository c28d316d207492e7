"""Keeps the newest samples of the loop for drawing."""

from __future__ import annotations

import numpy as np

# Columns of a sample: time [s], state, true friction, estimated friction, command [V].
TIME, PHI, PHI_DOT, THETA, THETA_DOT, FRICTION, ESTIMATE, COMMAND = range(8)
COLUMNS = 8


class Samples:
    """The newest ``size`` samples as rows of :data:`COLUMNS` columns; NaN where unknown.

    Time that goes backwards starts a new series: another graph, or a recording that was rewound.
    """

    def __init__(self, size: int) -> None:
        self._ring = np.full((size, COLUMNS), np.nan)
        self._next = self._kept = 0

    def add(self, sample: np.ndarray) -> None:
        """Add a sample (:data:`COLUMNS`,)."""
        if self._kept and sample[TIME] < self._ring[self._next - 1, TIME]:
            self.clear()
        self._ring[self._next] = sample
        self._next = (self._next + 1) % len(self._ring)
        self._kept = min(self._kept + 1, len(self._ring))

    def clear(self) -> None:
        """Forget all samples."""
        self._next = self._kept = 0

    def last(self, seconds: float) -> np.ndarray:
        """The samples (n, :data:`COLUMNS`) of the last ``seconds``, the oldest first."""
        rows = np.arange(self._next - self._kept, self._next) % len(self._ring)
        kept = self._ring[rows]
        if not len(kept):
            return kept
        return kept[kept[:, TIME] > kept[-1, TIME] - seconds]
