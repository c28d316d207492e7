"""The residual over uncertain rigs: how often it is small, how often the pendulum falls.

The residual is the arm's peak-to-peak angle in the settled part of a run. A fall counts as an
infinite residual.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.stats import binom, binomtest, sobol_indices, uniform

from furuta_analysis.simulation.batch import batch
from furuta_analysis.simulation.closed_loop import Loop
from furuta_studies.robustness.uncertain_rigs import UncertainRigs

# Probability with which an interval holds the true value.
CONFIDENCE = 0.95
# The quantile of the residual that is reported and minimised.
QUANTILE = 0.95
# Residual [rad] that a fall counts as, and the largest one, in Sobol indices, which need a number.
LARGEST_RESIDUAL = 2.0


class Probability(NamedTuple):
    """Estimated probability and its confidence interval (Clopper and Pearson)."""

    value: float
    low: float
    high: float


class Robustness(NamedTuple):
    """Result over all rigs; residuals in radians, infinite after a fall.

    ``p95_low_rad`` and ``p95_high_rad`` are the confidence interval of the quantile, from the order
    of the residuals alone. ``worst_rad`` is the largest residual without a fall.
    """

    runs: int
    within_bound: Probability
    fell: Probability
    falls: int
    p95_rad: float
    p95_low_rad: float
    p95_high_rad: float
    worst_rad: float


class Sensitivity(NamedTuple):
    """Sobol indices of an uncertain parameter: alone, and with all interactions."""

    parameter: str
    first_order: float
    total: float


def residuals(loops: Iterable[Loop], seconds: float) -> Iterator[float]:
    """The residual of each loop [rad], in order."""
    for each in batch(loops, seconds):
        yield np.inf if each.fell else each.phi_peak_to_peak_rad


def robustness(found: np.ndarray, bound: float) -> Robustness:
    """Evaluate the residuals [rad] against a ``bound`` [rad]."""
    ordered = np.sort(found)
    falls = int(np.sum(np.isinf(found)))
    low, high = binom.interval(CONFIDENCE, len(found), QUANTILE)
    standing = ordered[: len(found) - falls]
    return Robustness(
        len(found),
        probability(int(np.sum(found <= bound)), len(found)),
        probability(falls, len(found)),
        falls,
        quantile(ordered),
        float(ordered[max(int(low) - 1, 0)]),
        float(ordered[min(int(high), len(found) - 1)]),
        float(standing[-1]) if len(standing) else np.inf,
    )


def quantile(found: np.ndarray) -> float:
    """The smallest residual [rad] that :data:`QUANTILE` of all do not exceed."""
    return float(np.quantile(found, QUANTILE, method="inverted_cdf"))


def probability(successes: int, runs: int) -> Probability:
    """The probability of an event that happened in ``successes`` of ``runs``."""
    interval = binomtest(successes, runs).proportion_ci(CONFIDENCE, "exact")
    return Probability(successes / runs, float(interval.low), float(interval.high))


def sobol(
    rigs: UncertainRigs, points: int, seed: int, seconds: float, advance: Callable[[], None]
) -> list[Sensitivity]:
    """Sobol indices of the residual, by Saltelli's design with ``points`` (a power of two).

    It takes ``points`` times the number of parameters plus two runs, all with the same noise.
    """

    def evaluate(x: np.ndarray) -> np.ndarray:
        found = []
        for each in residuals(rigs.loops_at(x.T), seconds):
            found.append(min(each, LARGEST_RESIDUAL))
            advance()
        return np.array(found)

    indices = sobol_indices(func=evaluate, n=points, dists=[uniform()] * len(rigs.ranges), rng=seed)
    rows = zip(rigs.ranges, indices.first_order, indices.total_order, strict=True)
    return [Sensitivity(name, float(first), float(total)) for name, first, total in rows]
