"""Tunes the friction observer for the 95 % quantile of the residual over uncertain rigs.

All candidates are judged on the same rigs with the same noise, so that a difference is one between
the candidates. The result is judged on fresh rigs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from furuta.studies.robustness.robustness import LARGEST_RESIDUAL, quantile, residuals
from furuta.studies.robustness.uncertain_rigs import UncertainRigs
from furuta.studies.tuning.search import minimise_amplitude
from furuta_friction.compensation import ObserverParameters

# Name, and the quantile [rad] of a candidate.
ReportTrial = Callable[[int, float], None]
# Added to the seed for rigs that no candidate was tuned on.
FRESH = 1_000_003


class RobustTuning(NamedTuple):
    """The rigs, the parameters that are searched, and the effort.

    ``rivals`` are compensations that are tried before the search, which starts from the best one.
    """

    rigs: UncertainRigs
    search: tuple[str, ...]
    size: int
    trials: int
    seconds: float
    seed: int
    rivals: tuple[str, ...] = ()


class RobustResult(NamedTuple):
    """The tuned observer, and the quantile [rad] before and after, on tuning and fresh rigs.

    A quantile is infinite if more rigs fall than it leaves out.
    """

    observer: ObserverParameters
    before: float
    after: float
    fresh_before: float
    fresh_after: float
    trials: int


def tune_robustly(tuning: RobustTuning, fresh: int, report: ReportTrial) -> RobustResult:
    """Search from the given observer; it stays the result if nothing is better."""
    start = tuning.rigs.nominal.observer
    tried: list[tuple[float, ObserverParameters]] = []

    def amplitude(observer: ObserverParameters) -> float:
        found = _quantile(tuning, observer, tuning.size, tuning.seed)
        tried.append((found, observer))
        report(len(tried), found)
        return found

    before = amplitude(start)
    for each in tuning.rivals:
        if each != start.compensation:
            amplitude(start._replace(compensation=each))
    _, begin = min(tried, key=lambda each: each[0])
    # The search needs numbers.
    minimise_amplitude(
        lambda observer: min(amplitude(observer), LARGEST_RESIDUAL),
        begin,
        tuning.search,
        tuning.trials - len(tried),
    )
    after, best = min(tried, key=lambda each: each[0])
    seed = tuning.seed + FRESH
    fresh_before = _quantile(tuning, start, fresh, seed)
    fresh_after = fresh_before if best == start else _quantile(tuning, best, fresh, seed)
    return RobustResult(best, before, after, fresh_before, fresh_after, len(tried))


def _quantile(tuning: RobustTuning, observer: ObserverParameters, size: int, seed: int) -> float:
    rigs = tuning.rigs._replace(nominal=tuning.rigs.nominal._replace(observer=observer))
    found = np.fromiter(residuals(rigs.loops(size, seed), tuning.seconds), float, size)
    return quantile(found)
