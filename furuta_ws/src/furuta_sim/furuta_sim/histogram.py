"""Histogram of durations with bins of one microsecond, in constant memory."""

from __future__ import annotations

from array import array

import numpy as np

LAST_BIN = 20_000  # [µs] this bin also counts all longer durations
MICROSECOND = 1000  # [ns]
PERCENTILES = (50.0, 90.0, 99.0, 99.9)


class Histogram:
    """Counts durations."""

    def __init__(self) -> None:
        self._counts = array("Q", bytes(8 * (LAST_BIN + 1)))
        # The same memory as an array. Counting one duration is faster without numpy.
        self.counts = np.frombuffer(self._counts, dtype=np.uint64)
        self.largest = 0  # [ns]

    def add(self, duration: int) -> None:
        """Count a duration [ns]; a negative one counts as 0."""
        self.largest = max(self.largest, duration)
        self._counts[min(max(duration, 0) // MICROSECOND, LAST_BIN)] += 1

    @property
    def total(self) -> int:
        """Number of durations counted."""
        return int(self.counts.sum())

    def percentile(self, percent: float) -> float:
        """The duration [s] that ``percent`` of the durations did not exceed; NaN without any."""
        if not self.total:
            return float("nan")
        rank = max(1, int(np.ceil(percent / 100.0 * self.total)))
        bin_ = int(np.searchsorted(np.cumsum(self.counts), rank))
        return self.largest * 1e-9 if bin_ == LAST_BIN else (bin_ + 1) * 1e-6

    def coarse(self, width: int, bins: int) -> array[int]:
        """Counts in ``bins`` bins of ``width`` [µs]; the last one also counts longer durations."""
        return array("Q", np.add.reduceat(self.counts, np.arange(0, width * bins, width)).tobytes())

    def summary(self) -> str:
        """The percentiles as text."""
        parts = [
            f"{percent:g} % within {self.percentile(percent) * 1e6:.0f} µs"
            for percent in PERCENTILES
        ]
        return ", ".join([*parts, f"at most {self.largest * 1e-3:.0f} µs"])
