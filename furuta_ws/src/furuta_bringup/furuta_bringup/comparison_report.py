"""What ``furuta compare`` prints."""

from __future__ import annotations

from math import isfinite, isnan
from typing import Any

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table as Grid

from furuta.studies.comparison.scores import Score, Table
from furuta.studies.estimates import Estimate

# Most rigs that are listed one by one; columns of their names, and of a candidate's [characters].
MOST_LISTED = 30
RIG_WIDTH, CANDIDATE_WIDTH = 28, 13


def summary_of(scores: list[Score], table: Table, encoder_count: float) -> dict[str, Any]:
    """The result as a JSON object; an infinite residual, after a fall, is null."""
    return {
        "rigs": len(table.rigs),
        "encoder_count_rad": encoder_count,
        "ranking": [
            {
                name: each._asdict() if isinstance(each, Estimate) else each
                for name, each in score._asdict().items()
            }
            for score in scores
        ],
        "residual_rad": {
            name: dict(zip(table.rigs, map(float, table.residual[k]), strict=True))
            for k, name in enumerate(table.candidates)
        },
    }


def print_report(scores: list[Score], table: Table, encoder_count: float) -> None:
    """Print the residual per rig if there are few, and the ranking."""
    console = Console()
    if len(table.rigs) <= MOST_LISTED:
        columns = max(1, (console.width - RIG_WIDTH) // CANDIDATE_WIDTH)
        for first in range(0, len(table.candidates), columns):
            chosen = slice(first, first + columns)
            console.print(_rig_table(table, chosen, encoder_count))
    console.print(_sizes(scores, encoder_count))
    console.print(_counts(scores))


def _rig_table(table: Table, chosen: slice, encoder_count: float) -> Grid:
    grid = _grid("arm, peak to peak [mrad], by rig; bold: within one count", "rig")
    for name in table.candidates[chosen]:
        # A name may be wider than its column.
        grid.add_column(escape(name.replace("_", " ")), justify="right")
    for rig, residual in zip(table.rigs, table.residual[chosen].T, strict=True):
        cells = (_mrad(each) for each in residual)
        within = residual <= encoder_count
        marked = (f"[bold]{c}[/bold]" if ok else c for c, ok in zip(cells, within, strict=True))
        grid.add_row(escape(rig), *marked)
    return grid


def _sizes(scores: list[Score], encoder_count: float) -> Grid:
    rigs = scores[0].rigs
    grid = _grid(
        f"arm, peak to peak [mrad], over {rigs} rigs, with a 95 % confidence interval, rms u [V]; "
        f"one count is {1e3 * encoder_count:.1f}",
        *("candidate", "median", "95 %", "worst", "fell", "rms u"),
    )
    for score in scores:
        grid.add_row(
            escape(score.candidate),
            _mrad(score.residual_median_rad.value),
            _interval(score.residual_95_rad),
            _mrad(score.residual_worst_rad),
            str(score.falls),
            f"{score.command_rms_v:.3f}",
        )
    return grid


def _counts(scores: list[Score]) -> Grid:
    title = "rigs [%] within one count and better than the next candidate; rigs worse than none"
    headings = ["candidate", "within", "better", "worse"]
    if scores[0].pushes:
        title += "; pushes survived, lost although none survives"
        headings += ["pushes", "lost"]
    grid = _grid(title, *headings)
    for score in scores:
        cells = [
            escape(score.candidate),
            _percent(score.within_count),
            _percent(score.beats_next),
            _number(score.worse_than_none),
        ]
        if score.pushes:
            cells += [f"{score.pushes_survived}/{score.pushes}", _number(score.pushes_lost)]
        grid.add_row(*cells)
    return grid


def _grid(title: str, *headings: str) -> Grid:
    """A table whose first column is text."""
    grid = Grid(title=escape(title), box=SIMPLE)
    for number, heading in enumerate(headings):
        grid.add_column(escape(heading), justify="right" if number else "left", no_wrap=not number)
    return grid


def _interval(estimate: Estimate) -> str:
    return f"{_mrad(estimate.value)} ({_mrad(estimate.low)}–{_mrad(estimate.high)})"


def _mrad(value: float) -> str:
    if isfinite(value):
        return f"{1e3 * value:.1f}"
    return "?" if isnan(value) else "fell"


def _percent(estimate: Estimate | None) -> str:
    if estimate is None:
        return "–"
    value, low, high = (f"{100 * each:.0f}" for each in estimate)
    return f"{value} ({low}–{high})"


def _number(value: int | None) -> str:
    return "–" if value is None else str(value)
