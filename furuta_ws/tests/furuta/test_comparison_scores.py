"""Scores of a comparison, against closed forms and tables of the binomial distribution."""

from __future__ import annotations

from math import inf, isnan
from typing import Any

import numpy as np
import pytest

from furuta.studies.comparison.scores import quantile, rank, tabulate
from furuta.studies.estimates import fraction


def row(
    rig: str, candidate: str, size: float, *, fell: bool = False, push: float = 0.0
) -> dict[str, Any]:
    """A run as the table has it."""
    return {
        "rig": rig,
        "candidate": candidate,
        "seed": 0,
        "push_v": push,
        "phi_peak_to_peak_rad": size,
        "command_rms_v": 0.1,
        "fell": fell,
        "error": "",
    }


def test_quantile_intervals_are_order_statistics() -> None:
    """For the median of 100 values the 40th and the 61st, as tables give; few values give none."""
    assert quantile(np.arange(1.0, 101.0), 0.5) == (50.0, 40.0, 61.0)
    few = quantile(np.arange(1.0, 11.0), 0.95)
    assert few.value == 10.0
    assert isnan(few.high)


def test_quantiles_with_falls() -> None:
    """A fall is an infinite residual, and leaves the quantiles below it alone."""
    values = np.array([*np.arange(1.0, 100.0), inf])
    assert quantile(values, 0.5).value == 50.0
    assert quantile(values, 1.0 - 1e-9).value == inf


@pytest.mark.parametrize("n", [10, 1000])
def test_fractions_of_none_and_all(n: int) -> None:
    """The closed forms of Clopper and Pearson: 1 − 0.025^(1/n) for no hit of n."""
    limit = 1.0 - 0.025 ** (1.0 / n)
    assert fraction(0, n) == pytest.approx((0.0, 0.0, limit))
    assert fraction(n, n) == pytest.approx((1.0, 1.0 - limit, 1.0))


def test_residual_is_the_largest_over_the_seeds() -> None:
    """Runs with a push do not count, and a fall is infinite."""
    rows = [
        row("0", "none", 0.5),
        row("0", "none", 0.6),
        row("0", "none", 9.0, push=1.0),
        row("1", "none", 0.4, fell=True),
        row("1", "none", 0.5),
        row("1", "none", 0.5, push=1.0, fell=True),
    ]
    table = tabulate(rows)
    assert table.residual.tolist() == [[0.6, inf]]
    assert table.survived.tolist() == [[[True], [False]]]


def test_impossible_runs_are_left_out() -> None:
    """Their rig does not count."""
    rows = [row("0", "none", 0.5), {**row("1", "none", 0.0), "error": "no"}]
    assert tabulate(rows).rigs == ["0"]


def test_ranking() -> None:
    """By the largest residuals; harm and lost pushes are counted against no compensation."""
    rows = []
    for rig in range(20):
        name = str(rig)
        rows += [row(name, "none", 0.5), row(name, "none", 0.0, push=2.0)]
        rows += [row(name, "good", 0.02), row(name, "good", 0.0, push=2.0, fell=rig == 4)]
        # Better on most rigs, but it falls on two and is worse than none on one more.
        bad = {0: inf, 1: inf, 2: 0.7}.get(rig, 0.01)
        rows += [row(name, "bad", bad, fell=bad == inf), row(name, "bad", 0.0, push=2.0)]
    good, none, bad = rank(tabulate(rows), 0.025)
    assert [each.candidate for each in (good, none, bad)] == ["good", "none", "bad"]
    assert (good.falls, good.worse_than_none, good.pushes_lost) == (0, 0, 1)
    assert (bad.falls, bad.worse_than_none, bad.pushes_lost) == (2, 3, 0)
    assert (good.pushes, good.pushes_survived) == (20, 19)
    assert good.within_count.value == 1.0
    assert bad.within_count.value == pytest.approx(17 / 20)
    assert bad.residual_median_rad.value == 0.01
    assert good.beats_next is not None
    assert good.beats_next.value == 1.0
    assert none.beats_next is not None
    assert none.beats_next.value == pytest.approx(3 / 20)
    assert bad.beats_next is None


def test_without_the_uncompensated_loop() -> None:
    """Nothing is counted against it."""
    (score,) = rank(tabulate([row("0", "lugre", 0.02)]), 0.025)
    assert score.worse_than_none is None
    assert score.pushes_lost is None
