"""Scores of a comparison: the candidates over all rigs, and which one is recommended."""

from math import nan
from typing import Any, NamedTuple

import numpy as np

from furuta.studies.comparison.candidates import BANDWIDTHS
from furuta.studies.comparison.comparison import Table


class Score(NamedTuple):
    """A candidate over all rigs.

    ``within_count`` is the fraction of the rigs whose residual is at most one count of the encoder,
    and ``worse_than_none`` the number of those where it is larger by more than a count than without
    compensation, at most ``worst_ratio`` times as large (NaN if there are none).
    ``sensors_alone_rad`` is the residual of the nominal rig without friction and compensation.
    Commands are medians over the rigs.
    """

    candidate: str
    rigs: int
    residual_median_rad: float
    residual_95_rad: float
    residual_worst_rad: float
    within_count: float
    worse_than_none: int
    worst_ratio: float
    sensors_alone_rad: float
    falls: int
    command_rms_v: float
    command_step_v: float
    command_high_frequency_v: float
    delay_margin_s: float
    pushes: int
    pushes_survived: int


def rank(table: Table, encoder_count: float) -> list[Score]:
    """Scores from the best to the worst: by 95 % of the residual, then by its median."""
    scores = [_score(table, k, encoder_count) for k in range(len(table.candidates))]
    return sorted(scores, key=lambda score: (score.residual_95_rad, score.residual_median_rad))


def recommended(scores: list[Score], encoder_count: float) -> Score | None:
    """The candidate with the least chatter of those that are accurate, with which none fell.

    Accurate is a residual (95 %) within one count of the encoder, or else the smallest of all. None
    if pendulums fell with every candidate.
    """
    standing = [score for score in scores if score.falls == 0]
    enough = max(min((score.residual_95_rad for score in standing), default=0.0), encoder_count)
    accurate = [score for score in standing if score.residual_95_rad <= enough]
    return min(accurate, key=lambda score: score.command_step_v, default=None)


def best_bandwidths(table: Table) -> list[dict[str, Any]]:
    """The best of :data:`BANDWIDTHS`, the candidates, on each rig; NaN if it falls with all."""
    sizes, names = table.residual.min(axis=0), ("rig", "best_bandwidth", "residual_at_best_rad")
    best = np.where(np.isinf(sizes), nan, np.array(BANDWIDTHS)[table.residual.argmin(axis=0)])
    rows = zip(table.rigs, best.tolist(), sizes.tolist(), strict=True)
    return [dict(zip(names, row, strict=True)) for row in rows]


def _score(table: Table, k: int, encoder_count: float) -> Score:
    residual, survived = table.residual[k], table.survived[k]
    median, high = np.quantile(residual, [0.5, 0.95], method="inverted_cdf").tolist()
    falls = np.isinf(residual)
    worse = residual > table.uncompensated + encoder_count
    with np.errstate(divide="ignore"):
        ratios = residual[worse] / table.uncompensated[worse]
    return Score(
        table.candidates[k],
        len(table.rigs),
        median,
        high,
        float(residual.max()),
        int((residual <= encoder_count).sum()) / len(residual),
        len(ratios),
        float(ratios.max()) if len(ratios) else nan,
        table.sensors[k],
        int(falls.sum()),
        float(np.median(table.command[k])),
        float(np.median(table.step[k])),
        float(np.median(table.fast[k])),
        table.delay[k],
        survived.size,
        int(survived.sum()),
    )
