"""What ``furuta compare`` prints."""

from math import isfinite
from typing import Any, NamedTuple

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table as Grid

from furuta.studies.comparison.comparison import Table
from furuta.studies.comparison.scores import Score, recommended
from furuta.studies.comparison.tuning import TunedCandidate

# Columns of the names of rigs, and of a candidate's residuals [characters].
RIG_WIDTH, CANDIDATE_WIDTH = 28, 13
HEADINGS = ("median", "95 %", "worst", "within [%]", "fell", "rms u", "pushes")


class Report(NamedTuple):
    """Residuals by rig, scores from the best candidate to the worst, one encoder count [rad].

    ``impossible`` is the number of rigs that were left out.
    """

    table: Table
    scores: list[Score]
    encoder_count: float
    impossible: int
    tuned: list[TunedCandidate]

    def as_json(self, by_rig: bool) -> dict[str, Any]:
        """The JSON object; with the residuals ``by_rig`` of the named rigs."""
        best = recommended(self.scores)
        summary: dict[str, Any] = {
            "rigs": len(self.table.rigs),
            "impossible": self.impossible,
            "encoder_count_rad": self.encoder_count,
            "ranking": [score._asdict() for score in self.scores],
            "recommended": best.candidate if best else None,
            "tuned": [candidate._asdict() for candidate in self.tuned],
        }
        if by_rig:
            summary["rows"] = [
                {"truth": rig, "compensation": candidate, "phi_peak_to_peak_rad": float(size)}
                for rig, sizes in zip(self.table.rigs, self.table.residual.T, strict=True)
                for candidate, size in zip(self.table.candidates, sizes, strict=True)
            ]
        return summary

    def print(self, by_rig: bool) -> None:
        """Print the residuals ``by_rig``, the ranking and what was tuned."""
        console = Console()
        if by_rig:
            columns = max(1, (console.width - RIG_WIDTH) // CANDIDATE_WIDTH)
            for first in range(0, len(self.table.candidates), columns):
                console.print(self._residuals(slice(first, first + columns)))
        console.print(self._ranking())
        for tuned in self.tuned:
            settings = ", ".join(f"{name} {value}" for name, value in tuned.settings.items())
            print(f"tuned {tuned.candidate}: {settings}")
        if self.impossible:
            print(f"left out: {self.impossible} rigs whose parameters are impossible")
        if best := recommended(self.scores):
            limit = f"fewer than {best.falls_below:.1%} fall (95 % confidence)"
            print(f"recommended: {best.candidate}; {limit}")
        else:
            print("recommended: no candidate, because a pendulum falls with each of them")

    def _residuals(self, chosen: slice) -> Grid:
        names = (name.replace("_", " ") for name in self.table.candidates[chosen])
        grid = _grid("arm, peak to peak [mrad], by rig; bold: within one count", "rig", *names)
        for rig, sizes in zip(self.table.rigs, self.table.residual[chosen].T, strict=True):
            marks = ("bold" if size <= self.encoder_count else "none" for size in sizes)
            texts = (_mrad(float(size)) for size in sizes)
            pairs = zip(marks, texts, strict=True)
            grid.add_row(escape(rig), *(f"[{mark}]{text}[/]" for mark, text in pairs))
        return grid

    def _ranking(self) -> Grid:
        title = (
            f"arm, peak to peak [mrad], over {len(self.table.rigs)} rigs, with a 95 % confidence "
            f"interval; rigs within one count, which is {1e3 * self.encoder_count:.1f}; rms u [V]"
        )
        grid = _grid(title, "candidate", *HEADINGS)
        for score in self.scores:
            interval = f"({_mrad(score.residual_95_low_rad)}–{_mrad(score.residual_95_high_rad)})"
            grid.add_row(
                escape(score.candidate),
                _mrad(score.residual_median_rad),
                f"{_mrad(score.residual_95_rad)} {interval}",
                _mrad(score.residual_worst_rad),
                f"{100 * score.within_count:.0f}",
                str(score.falls),
                f"{score.command_rms_v:.3f}",
                f"{score.pushes_survived}/{score.pushes}" if score.pushes else "–",
            )
        return grid


def _grid(title: str, *headings: str) -> Grid:
    """A table whose first column is text."""
    grid = Grid(title=escape(title), box=SIMPLE)
    for number, heading in enumerate(headings):
        grid.add_column(escape(heading), justify="right" if number else "left", no_wrap=not number)
    return grid


def _mrad(value: float) -> str:
    if isfinite(value):
        return f"{1e3 * value:.1f}"
    return "fell" if value > 0 else "?"
