"""Scores of a comparison: residuals with exact confidence intervals, falls, pushes and ranking.

The unit is the rig: its residual is the largest arm angle, peak to peak, over the noise seeds, and
infinite after a fall. Rigs are independent, so intervals follow from the binomial distribution
alone: quantiles from order statistics (Conover 1999), fractions as in
:mod:`furuta.studies.estimates`.
"""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import quantile_test

from furuta.studies.estimates import CONFIDENCE, Estimate, fraction

# Candidate that shows what the rig does by itself.
UNCOMPENSATED = "none"

Rows = list[dict[str, Any]]


class Score(NamedTuple):
    """A candidate over all rigs.

    ``within_count`` is the fraction of the rigs whose residual is at most one count of the encoder,
    ``beats_next`` the fraction on which it is below that of the next rank. ``worse_than_none``
    counts rigs with a residual above that without compensation, ``pushes_lost`` pushes which only
    the loop without compensation survives. Both are None without a candidate ``none``.
    """

    candidate: str
    rigs: int
    residual_median_rad: Estimate
    residual_95_rad: Estimate
    residual_worst_rad: float
    within_count: Estimate
    command_rms_v: float
    falls: int
    worse_than_none: int | None
    pushes: int
    pushes_survived: int
    pushes_lost: int | None
    beats_next: Estimate | None


class Table(NamedTuple):
    """Residuals [rad] and rms commands [V] (candidates, rigs), and which pushes were survived."""

    candidates: list[str]
    rigs: list[str]
    residual: np.ndarray
    command: np.ndarray
    survived: np.ndarray


def tabulate(rows: Rows) -> Table:
    """The table of the runs. Rigs that are impossible are left out."""
    possible = [row for row in rows if not row["error"]]
    candidates = list(dict.fromkeys(row["candidate"] for row in possible))
    rigs = list(dict.fromkeys(row["rig"] for row in possible))
    plain: dict[tuple[str, str], Rows] = {(c, r): [] for c in candidates for r in rigs}
    pushed: dict[tuple[str, str], Rows] = {key: [] for key in plain}
    for row in possible:
        kind = pushed if row["push_v"] else plain
        kind[row["candidate"], row["rig"]].append(row)
    shape = len(candidates), len(rigs)
    return Table(
        candidates,
        rigs,
        np.reshape([_residual(runs) for runs in plain.values()], shape),
        np.reshape([_mean(runs) for runs in plain.values()], shape),
        np.array([[not row["fell"] for row in runs] for runs in pushed.values()], bool).reshape(
            *shape, -1
        ),
    )


def _residual(runs: Rows) -> float:
    return max(inf if row["fell"] else float(row["phi_peak_to_peak_rad"]) for row in runs)


def _mean(runs: Rows) -> float:
    return float(np.mean([row["command_rms_v"] for row in runs]))


def rank(table: Table, encoder_count: float) -> list[Score]:
    """Scores from the best to the worst: by 95 % of the residual, then by its median."""
    scores = [_score(table, k, encoder_count) for k in range(len(table.candidates))]
    scores.sort(key=lambda each: (each.residual_95_rad.value, each.residual_median_rad.value))
    for k in range(len(scores) - 1):
        better = table.residual[table.candidates.index(scores[k].candidate)]
        next_one = table.residual[table.candidates.index(scores[k + 1].candidate)]
        scores[k] = scores[k]._replace(beats_next=_fraction(better < next_one))
    return scores


def _score(table: Table, k: int, encoder_count: float) -> Score:
    residual, survived = table.residual[k], table.survived[k]
    score = Score(
        table.candidates[k],
        len(table.rigs),
        quantile(residual, 0.5),
        quantile(residual, 0.95),
        float(residual.max()),
        _fraction(residual <= encoder_count),
        float(np.median(table.command[k])),
        int(np.isinf(residual).sum()),
        None,
        survived.size,
        int(survived.sum()),
        None,
        None,
    )
    if UNCOMPENSATED not in table.candidates:
        return score
    none = table.candidates.index(UNCOMPENSATED)
    return score._replace(
        worse_than_none=int((residual > table.residual[none]).sum()),
        pushes_lost=int((table.survived[none] & ~survived).sum()),
    )


def quantile(values: np.ndarray, fraction: float) -> Estimate:
    """A quantile, which is one of the ``values``, with its exact interval."""
    value = float(np.quantile(values, fraction, method="inverted_cdf"))
    low, high = quantile_test(values, q=value, p=fraction).confidence_interval(CONFIDENCE)
    return Estimate(value, float(low), float(high))


def _fraction(hits: np.ndarray) -> Estimate:
    """The fraction of the rigs that are ``hits`` (n,)."""
    return fraction(int(np.sum(hits)), len(hits))
