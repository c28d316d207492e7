"""How late things were: counts in bins of a microsecond, in the same memory however many."""

from __future__ import annotations

from array import array

import numpy as np

LAST = 20_000  # [µs] this bin holds all that was later still
MICROSECOND = 1000  # [ns]
PERCENTILES = (50.0, 90.0, 99.0, 99.9)


class Histogram:
    """Counts of durations."""

    def __init__(self) -> None:
        self._counts = array("Q", bytes(8 * (LAST + 1)))
        # The same memory for arithmetic: counting one is faster without numpy.
        self.counts = np.frombuffer(self._counts, dtype=np.uint64)
        self.largest = 0  # [ns]

    def add(self, duration: int) -> None:
        """Count a duration [ns]; a negative one is none."""
        self.largest = max(self.largest, duration)
        self._counts[min(max(duration, 0) // MICROSECOND, LAST)] += 1

    @property
    def total(self) -> int:
        """How many were counted."""
        return int(self.counts.sum())

    def percentile(self, share: float) -> float:
        """The duration [s] that ``share`` percent did not exceed, NaN without any."""
        if not self.total:
            return float("nan")
        wanted = max(1, int(np.ceil(share / 100.0 * self.total)))
        found = int(np.searchsorted(np.cumsum(self.counts), wanted))
        return self.largest * 1e-9 if found == LAST else (found + 1) * 1e-6

    def coarse(self, width: int, bins: int) -> array[int]:
        """Counts in ``bins`` bins of ``width`` [µs], the last with all that was later."""
        return array("Q", np.add.reduceat(self.counts, np.arange(0, width * bins, width)).tobytes())

    def summary(self) -> str:
        """Percentiles in words."""
        parts = [
            f"{share:g} % within {self.percentile(share) * 1e6:.0f} µs" for share in PERCENTILES
        ]
        return ", ".join([*parts, f"at most {self.largest * 1e-3:.0f} µs"])
