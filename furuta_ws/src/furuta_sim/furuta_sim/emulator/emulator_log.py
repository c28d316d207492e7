"""Log of an emulated rig, sample by sample."""

from __future__ import annotations

from pathlib import Path

import numpy as np

COLUMNS = ("time_ns", "phi", "phi_dot", "theta", "theta_dot", "volts", "armed", "sample")
# Rows allocated at once.
BLOCK = 60_000


class EmulatorLog:
    """A growing table with a row per sample; ``time_ns`` is when it was due (steady clock)."""

    def __init__(self) -> None:
        self._blocks = [np.empty((BLOCK, len(COLUMNS)))]
        self._length = 0

    def add(self, time_ns: int, x: np.ndarray, volts: float, armed: bool, sample: int) -> None:
        """Add a row: state ``x`` (4 or more) after ``volts`` [V] over the last sample."""
        at = self._length % BLOCK
        if at == 0 and self._length:
            self._blocks.append(np.empty((BLOCK, len(COLUMNS))))
        row = self._blocks[-1][at]
        row[0], row[1:5], row[5], row[6], row[7] = time_ns, x[:4], volts, armed, sample
        self._length += 1

    def table(self) -> np.ndarray:
        """Return all rows so far (n, 8), columns as in :data:`COLUMNS`."""
        length = self._length
        return np.concatenate(self._blocks)[:length]

    def save(self, path: Path) -> int:
        """Write the rows to an ``.npz`` file; returns their number."""
        table = self.table()
        np.savez(path, **dict(zip(COLUMNS, table.T, strict=True)))
        return len(table)
