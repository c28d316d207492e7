"""Samples of the loop for drawing: their columns, and the newest ones."""

from collections import deque

import numpy as np

# Columns of a sample, as the page has them (web/source.js): time [s], arm angle and speed,
# pendulum, true friction, estimated friction, command [V].
TIME, PHI, PHI_DOT, THETA, FRICTION, ESTIMATE, COMMAND = range(7)
COLUMNS = 7


class Samples:
    """The newest ``size`` samples as rows of :data:`COLUMNS` columns; NaN where unknown.

    Time that goes backwards starts a new series: another graph. ``new`` are those since it was
    emptied.
    """

    def __init__(self, size: int) -> None:
        self._rows: deque[np.ndarray] = deque(maxlen=size)
        self.new: list[np.ndarray] = []

    def add(self, sample: np.ndarray) -> None:
        """Add a sample (:data:`COLUMNS`,)."""
        if self._rows and sample[TIME] < self._rows[-1][TIME]:
            self._rows.clear()
        self._rows.append(sample)
        self.new.append(sample)

    def last(self, seconds: float) -> np.ndarray:
        """The samples (n, :data:`COLUMNS`) of the last ``seconds``, the oldest first."""
        rows = np.array(self._rows).reshape(-1, COLUMNS)
        return rows[rows[:, TIME] > rows[-1:, TIME] - seconds]
