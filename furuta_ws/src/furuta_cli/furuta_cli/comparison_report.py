"""What ``furuta compare`` prints."""

from __future__ import annotations

from math import isfinite, isnan
from typing import Any

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table as Grid

from furuta_studies.comparison.scores import Estimate, Score, Table

# Most rigs that are listed one by one.
MOST_LISTED = 30


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
        console.print(_rig_table(scores, table, encoder_count))
    console.print(_ranking(scores, encoder_count))


def _rig_table(scores: list[Score], table: Table, encoder_count: float) -> Grid:
    grid = Grid(
        title=escape("arm, peak to peak [mrad], by rig; bold: within one count"), box=SIMPLE
    )
    grid.add_column("rig", no_wrap=True)
    for name in table.candidates:
        grid.add_column(escape(name), justify="right")
    for rig, residual in zip(table.rigs, table.residual.T, strict=True):
        cells = (_mrad(each) for each in residual)
        within = residual <= encoder_count
        marked = (f"[bold]{c}[/bold]" if ok else c for c, ok in zip(cells, within, strict=True))
        grid.add_row(escape(rig), *marked)
    return grid


def _ranking(scores: list[Score], encoder_count: float) -> Grid:
    grid = Grid(
        title=escape(
            f"arm, peak to peak [mrad], over {scores[0].rigs} rigs (95 % confidence intervals); "
            f"one count is {1e3 * encoder_count:.1f}"
        ),
        box=SIMPLE,
    )
    grid.add_column("candidate", no_wrap=True)
    headings = ["median", "95 %", "worst", "within a count", escape("rms u [V]"), "fell"]
    headings += ["above none", "pushes survived", "lost", "beats next"]
    for heading in headings:
        grid.add_column(heading, justify="right")
    for score in scores:
        grid.add_row(escape(score.candidate), *_cells(score))
    return grid


def _cells(score: Score) -> list[str]:
    return [
        _interval(score.residual_median_rad),
        _interval(score.residual_95_rad),
        _mrad(score.residual_worst_rad),
        _percent(score.within_count),
        f"{score.command_rms_v:.3f}",
        str(score.falls),
        _number(score.worse_than_none),
        f"{score.pushes_survived}/{score.pushes}",
        _number(score.pushes_lost),
        _percent(score.beats_next),
    ]


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
    return f"{value} % ({low}–{high})"


def _number(value: int | None) -> str:
    return "–" if value is None else str(value)
