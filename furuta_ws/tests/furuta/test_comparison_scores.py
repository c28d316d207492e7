"""Scores of a comparison."""

from math import inf, nan

import numpy as np
import pytest

from furuta.studies.comparison.candidates import BANDWIDTHS
from furuta.studies.comparison.comparison import Table
from furuta.studies.comparison.scores import best_bandwidths, rank, recommended


def table(
    sizes: dict[str, list[float]],
    survived: dict[str, list[bool]] | None = None,
    step: float | np.ndarray = 0.005,
    uncompensated: tuple[float, ...] | float = 0.5,
) -> Table:
    """The table of candidates with these residuals and steps, and with one push per rig."""
    residual = np.array(list(sizes.values()))
    pushes = [[[each] for each in row] for row in (survived or {}).values()]
    return Table(
        list(sizes),
        [str(k) for k in range(residual.shape[1])],
        residual,
        np.full(residual.shape, 0.1),
        np.broadcast_to(step, residual.T.shape).T,
        np.full(residual.shape, 0.01),
        np.array(pushes, bool) if pushes else np.empty((*residual.shape, 0), bool),
        np.broadcast_to(uncompensated, residual[0].shape),
        len(sizes) * [0.05],
        len(sizes) * [0.002],
    )


def test_ranking() -> None:
    """By the largest residuals: one that is better on most rigs but falls on two is last."""
    bad = [inf, inf, 0.7] + 17 * [0.01]
    sizes = {"none": 20 * [0.5], "good": 20 * [0.02], "bad": bad}
    survived = {"none": 20 * [True], "good": [rig != 4 for rig in range(20)], "bad": 20 * [True]}
    scores = rank(table(sizes, survived), 0.025)
    good, _, bad_score = scores
    assert [score.candidate for score in scores] == ["good", "none", "bad"]
    assert (good.falls, bad_score.falls) == (0, 2)
    assert (good.pushes, good.pushes_survived) == (20, 19)
    assert (good.within_count, bad_score.within_count) == (1.0, 17 / 20)
    assert bad_score.residual_median_rad == 0.01
    assert recommended(scores, 0.025) == good
    assert recommended(rank(table({"lugre": [0.02, inf]}), 0.025), 0.025) is None


def test_the_smoothest_of_the_accurate_is_recommended() -> None:
    """Within a count accuracy does not decide; beyond it, it does; and a fall excludes."""
    sizes = {"fine": 5 * [0.002], "smooth": 5 * [0.02], "coarse": 5 * [0.03], "falls": [0.0, inf]}
    sizes["falls"] += 3 * [0.0]
    scores = rank(table(sizes, step=np.array([0.05, 0.005, 0.001, 0.001])), 0.025)
    best = {count: recommended(scores, count) for count in (0.0, 0.025, 0.04)}
    found = {count: score.candidate for count, score in best.items() if score}
    assert found == {0.0: "fine", 0.025: "smooth", 0.04: "coarse"}


def test_worse_than_none() -> None:
    """By more than a count; falling as none does is not worse, and the smallest ratio is nan."""
    sizes = {"all": [0.1, 0.02, inf], "falls": [0.5, inf, 0.1], "never": [0.024, 0.025, inf]}
    scores = rank(table(sizes, uncompensated=(0.05, 0.0, inf)), 0.025)
    found = {score.candidate: (score.worse_than_none, score.worst_ratio) for score in scores}
    assert found["all"] == (1, 2.0)
    assert found["falls"] == (2, inf)
    assert found["never"] == (0, pytest.approx(nan, nan_ok=True))
    assert {score.sensors_alone_rad for score in scores} == {0.002}


def test_best_bandwidth_of_each_rig() -> None:
    """The one with the smallest residual, and none where the pendulum always falls."""
    sizes = {f"{k:g}": [0.5 - 0.001 * k, 0.01 + 0.1 * k, inf] for k in BANDWIDTHS}
    found = best_bandwidths(table(sizes))
    assert [row["best_bandwidth"] for row in found] == pytest.approx([100.0, 0.0, nan], nan_ok=True)
    assert found[0] == {"rig": "0", "best_bandwidth": 100.0, "residual_at_best_rad": 0.4}
    assert found[2]["residual_at_best_rad"] == inf
