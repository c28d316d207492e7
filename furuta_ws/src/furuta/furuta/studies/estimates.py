"""Estimates from independent runs, with exact confidence intervals.

The intervals follow from the binomial distribution alone (Clopper and Pearson 1934).
"""

from __future__ import annotations

from math import nan
from typing import NamedTuple

from scipy.stats import binomtest

# Probability with which an interval holds the true value.
CONFIDENCE = 0.95


class Estimate(NamedTuple):
    """A value and its confidence interval; an end is NaN if there are too few runs for it."""

    value: float
    low: float
    high: float


def fraction(hits: int, runs: int) -> Estimate:
    """The probability of what happened in ``hits`` of ``runs``; NaN without runs."""
    if runs == 0:
        return Estimate(nan, nan, nan)
    low, high = binomtest(hits, runs).proportion_ci(CONFIDENCE, method="exact")
    return Estimate(hits / runs, float(low), float(high))


def fraction_below(hits: int, runs: int) -> float:
    """The probability that the true one is below with :data:`CONFIDENCE`: a one-sided interval."""
    test = binomtest(hits, runs, alternative="less")
    return float(test.proportion_ci(CONFIDENCE, method="exact").high)
