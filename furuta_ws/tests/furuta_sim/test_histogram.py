"""Histograms of durations."""

import numpy as np
import pytest

from furuta_sim.realtime import LAST_BIN, Histogram


def test_percentiles_are_those_of_the_durations() -> None:
    """Within the bin width of a microsecond."""
    durations = np.random.default_rng(1).exponential(200e-6, 10_000)
    histogram = Histogram()
    for each in durations:
        histogram.add(int(each * 1e9))
    assert histogram.total == 10_000
    for percent in (1.0, 50.0, 99.0, 99.9):
        assert histogram.percentile(percent) == pytest.approx(
            np.percentile(durations, percent, method="inverted_cdf"), abs=1.1e-6
        )
    assert histogram.largest == int(durations.max() * 1e9)


def test_long_durations_are_counted() -> None:
    """In the last bin and in the largest duration, which is then the percentile."""
    histogram = Histogram()
    histogram.add(5_000_000_000)
    histogram.add(-3)
    assert list(np.flatnonzero(histogram.counts)) == [0, LAST_BIN]
    assert histogram.percentile(100.0) == pytest.approx(5.0)
