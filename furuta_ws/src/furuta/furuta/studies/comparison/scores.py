"""Scores of a comparison, with exact confidence intervals of 95 %.

Rigs are independent, so intervals follow from the binomial distribution alone: quantiles from order
statistics (Conover 1999), fractions by the method of Clopper and Pearson (1934). An end is NaN if
there are too few rigs for it.
"""

from typing import NamedTuple

import numpy as np
from scipy.stats import binomtest, quantile_test

from furuta.studies.comparison.comparison import Table

CONFIDENCE = 0.95
# Candidate that shows what the rig does by itself.
UNCOMPENSATED = "none"


class Score(NamedTuple):
    """A candidate over all rigs.

    ``within_count`` is the fraction of the rigs whose residual is at most one count of the encoder,
    ``beats_next`` the fraction on which it is below that of the next rank. The probability of a
    fall is less than ``falls_below`` (one-sided limit). ``worse_than_none`` counts rigs with a
    residual above that without compensation, ``pushes_lost`` pushes which only the loop without
    compensation survives. Both are None without a candidate ``none``.
    """

    candidate: str
    rigs: int
    residual_median_rad: float
    residual_95_rad: float
    residual_95_low_rad: float
    residual_95_high_rad: float
    residual_worst_rad: float
    within_count: float
    within_count_low: float
    within_count_high: float
    falls: int
    falls_below: float
    command_rms_v: float
    pushes: int
    pushes_survived: int
    worse_than_none: int | None = None
    pushes_lost: int | None = None
    beats_next: float | None = None
    beats_next_low: float | None = None


def rank(table: Table, encoder_count: float) -> list[Score]:
    """Scores from the best to the worst: by 95 % of the residual, then by its median."""
    scores = [_score(table, k, encoder_count) for k in range(len(table.candidates))]
    scores.sort(key=lambda score: (score.residual_95_rad, score.residual_median_rad))
    residual = dict(zip(table.candidates, table.residual, strict=True))
    for k in range(len(scores) - 1):
        better = residual[scores[k].candidate] < residual[scores[k + 1].candidate]
        value, low, _ = fraction(better)
        scores[k] = scores[k]._replace(beats_next=value, beats_next_low=low)
    return scores


def recommended(scores: list[Score]) -> Score | None:
    """The best candidate with which no pendulum fell; None if there is none."""
    return next((score for score in scores if score.falls == 0), None)


def _score(table: Table, k: int, encoder_count: float) -> Score:
    residual, survived = table.residual[k], table.survived[k]
    score = Score(
        table.candidates[k],
        len(table.rigs),
        quantile(residual, 0.5)[0],
        *quantile(residual, 0.95),
        float(residual.max()),
        *fraction(residual <= encoder_count),
        int(np.isinf(residual).sum()),
        probability_below(np.isinf(residual)),
        float(np.median(table.command[k])),
        survived.size,
        int(survived.sum()),
    )
    if UNCOMPENSATED not in table.candidates:
        return score
    none = table.candidates.index(UNCOMPENSATED)
    return score._replace(
        worse_than_none=int((residual > table.residual[none]).sum()),
        pushes_lost=int((table.survived[none] & ~survived).sum()),
    )


def quantile(values: np.ndarray, part: float) -> tuple[float, float, float]:
    """A quantile, which is one of the ``values``, with its interval."""
    value = float(np.quantile(values, part, method="inverted_cdf"))
    low, high = quantile_test(values, q=value, p=part).confidence_interval(CONFIDENCE)
    return value, float(low), float(high)


def fraction(hits: np.ndarray) -> tuple[float, float, float]:
    """The fraction of the rigs that are ``hits`` (n,), with its interval."""
    number = int(np.sum(hits))
    low, high = binomtest(number, len(hits)).proportion_ci(CONFIDENCE, method="exact")
    return number / len(hits), float(low), float(high)


def probability_below(hits: np.ndarray) -> float:
    """The probability of ``hits`` (n,) is below it with :data:`CONFIDENCE`."""
    test = binomtest(int(np.sum(hits)), len(hits), alternative="less")
    return float(test.proportion_ci(CONFIDENCE, method="exact").high)
