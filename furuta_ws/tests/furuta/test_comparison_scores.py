"""Scores of a comparison, against closed forms and tables of the binomial distribution."""

from math import inf, isnan

import numpy as np
import pytest
from scipy import stats

from furuta.studies.comparison.comparison import Table
from furuta.studies.comparison.scores import probability_below, quantile, rank, recommended


def table(
    sizes: dict[str, list[float]],
    survived: dict[str, list[bool]] | None = None,
    step: float | np.ndarray = 0.005,
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
        len(sizes) * [0.05],
    )


def test_quantile_intervals_are_order_statistics() -> None:
    """For the median of 100 values the 40th and the 61st, as tables give; few values give none."""
    assert quantile(np.arange(1.0, 101.0), 0.5) == (50.0, 40.0, 61.0)
    value, _, high = quantile(np.arange(1.0, 11.0), 0.95)
    assert value == 10.0
    assert isnan(high)


@pytest.mark.parametrize("n", [1, 7, 60, 1000])
@pytest.mark.parametrize("part", [0.5, 0.95])
def test_quantile_intervals_are_those_of_scipy(n: int, part: float) -> None:
    """Also with ties, and where the values are too few."""
    if not hasattr(stats, "quantile_test"):
        pytest.skip("scipy has quantile_test since 1.12")
    values = np.random.default_rng(n).integers(0, 2 * n, n).astype(float)
    value, low, high = quantile(values, part)
    expected = stats.quantile_test(values, q=value, p=part).confidence_interval(0.95)
    np.testing.assert_array_equal((low, high), tuple(expected))


@pytest.mark.parametrize("n", [10, 1000])
def test_probability_of_what_has_not_happened(n: int) -> None:
    """The closed form of Clopper and Pearson: 1 − 0.05^(1/n) for no hit of n."""
    assert probability_below(np.zeros(n, bool)) == pytest.approx(1.0 - 0.05 ** (1.0 / n))


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
