"""Scores of a comparison, against closed forms and tables of the binomial distribution."""

from math import inf, isnan

import numpy as np
import pytest

from furuta.studies.comparison.comparison import Table
from furuta.studies.comparison.scores import (
    fraction,
    probability_below,
    quantile,
    rank,
    recommended,
)


def table(sizes: dict[str, list[float]], survived: dict[str, list[bool]] | None = None) -> Table:
    """The table of candidates with these residuals, and with one push per rig."""
    residual = np.array(list(sizes.values()))
    pushes = [[[each] for each in row] for row in (survived or {}).values()]
    return Table(
        list(sizes),
        [str(k) for k in range(residual.shape[1])],
        residual,
        np.full(residual.shape, 0.1),
        np.array(pushes, bool) if pushes else np.empty((*residual.shape, 0), bool),
    )


def test_quantile_intervals_are_order_statistics() -> None:
    """For the median of 100 values the 40th and the 61st, as tables give; few values give none."""
    assert quantile(np.arange(1.0, 101.0), 0.5) == (50.0, 40.0, 61.0)
    value, _, high = quantile(np.arange(1.0, 11.0), 0.95)
    assert value == 10.0
    assert isnan(high)


def test_quantiles_with_falls() -> None:
    """A fall is an infinite residual, and leaves the quantiles below it alone."""
    values = np.array([*np.arange(1.0, 100.0), inf])
    assert quantile(values, 0.5)[0] == 50.0
    assert quantile(values, 1.0 - 1e-9)[0] == inf


@pytest.mark.parametrize("n", [10, 1000])
def test_fractions_of_none_and_all(n: int) -> None:
    """The closed forms of Clopper and Pearson: 1 − 0.025^(1/n) for no hit of n."""
    limit = 1.0 - 0.025 ** (1.0 / n)
    assert fraction(np.zeros(n, bool)) == pytest.approx((0.0, 0.0, limit))
    assert fraction(np.ones(n, bool)) == pytest.approx((1.0, 1.0 - limit, 1.0))
    assert probability_below(np.zeros(n, bool)) == pytest.approx(1.0 - 0.05 ** (1.0 / n))


def test_a_fraction_as_tables_give_it() -> None:
    """3 of 100 is 0.62 % to 8.52 %."""
    assert fraction(np.arange(100) < 3) == pytest.approx((0.03, 0.0062, 0.0852), abs=1e-4)


def test_ranking() -> None:
    """By the largest residuals; harm and lost pushes are counted against no compensation."""
    # Better on most rigs, but it falls on two and is worse than none on one more.
    bad = [inf, inf, 0.7] + 17 * [0.01]
    sizes = {"none": 20 * [0.5], "good": 20 * [0.02], "bad": bad}
    survived = {"none": 20 * [True], "good": [rig != 4 for rig in range(20)], "bad": 20 * [True]}
    scores = rank(table(sizes, survived), 0.025)
    good, none, bad_score = scores
    assert [score.candidate for score in scores] == ["good", "none", "bad"]
    assert (good.falls, good.worse_than_none, good.pushes_lost) == (0, 0, 1)
    assert (bad_score.falls, bad_score.worse_than_none, bad_score.pushes_lost) == (2, 3, 0)
    assert (good.pushes, good.pushes_survived) == (20, 19)
    assert good.within_count == 1.0
    assert bad_score.within_count == pytest.approx(17 / 20)
    assert bad_score.residual_median_rad == 0.01
    assert good.beats_next == 1.0
    assert none.beats_next == pytest.approx(3 / 20)
    assert bad_score.beats_next is None
    assert recommended(scores) == good


def test_nothing_is_recommended_if_all_fall() -> None:
    """And without the uncompensated loop nothing is counted against it."""
    scores = rank(table({"lugre": [0.02, inf]}), 0.025)
    assert recommended(scores) is None
    assert scores[0].worse_than_none is None
    assert scores[0].pushes_lost is None
