"""Figure of a comparison: the distribution of the residual for each candidate."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from furuta.figures.figure import axes_for, legend_outside, style_axis
from furuta.studies.comparison.comparison import Table

LABEL = "arm, peak to peak [rad]"
COUNT = "one encoder count"
# Widest scatter of the points of a candidate, which shows how many there are.
SCATTER = 0.3
# Most points per candidate that are drawn singly.
MOST_POINTS = 300
# A fall is drawn at this multiple of the largest residual.
FALL = 2.0


def draw_comparison(table: Table, order: list[str], encoder_count: float, axes: Any = None) -> Any:
    """Draw points per candidate in ``order``, and the fraction of rigs above a residual."""
    finite = table.residual[np.isfinite(table.residual)]
    fall = FALL * float(finite.max(initial=1.0))
    height = 2.0 + 0.55 * len(order)
    figure, axes = axes_for(axes, 1, 2, figsize=(13, max(height, 4.5)))
    points, above = axes
    for number, name in enumerate(order):
        residual = table.residual[table.candidates.index(name)]
        drawn = np.where(np.isinf(residual), fall, residual)
        _draw_points(points, number, drawn)
        _draw_fraction_above(above, number, drawn, name)
    points.set_yticks(range(len(order)), order)
    points.invert_yaxis()
    for axis in (points, above):
        axis.axvline(encoder_count, color="0.3", ls="--", lw=1, label=COUNT)
        axis.set_xscale("log")
    if np.isinf(table.residual).any():
        points.axvline(fall, color="tab:red", lw=0.8, label="fell")
    points.plot([], [], "k|", ms=12, label="median, 95 %, worst")
    entries = points.get_legend_handles_labels()
    legend_outside(figure, "lower center", *entries, ncols=3)
    above.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small")
    style_axis(points, LABEL)
    style_axis(above, LABEL, f"fraction of {len(table.rigs)} rigs that swing further")
    return axes


def _draw_points(axis: Axes, number: int, residual: np.ndarray) -> None:
    scatter = np.random.default_rng(number).uniform(-SCATTER, SCATTER, len(residual))
    some = slice(None, MOST_POINTS)
    axis.plot(residual[some], number + scatter[some], ".", ms=4, alpha=0.5, color=f"C{number}")
    marks = np.quantile(residual, [0.5, 0.95, 1.0], method="inverted_cdf")
    axis.plot(marks, [number] * 3, "k|", ms=16, mew=1.5)


def _draw_fraction_above(axis: Axes, number: int, residual: np.ndarray, name: str) -> None:
    sizes = np.sort(residual)
    above = np.linspace(1.0, 0.0, len(sizes) + 1)
    style = "-" if number < 10 else "--"  # there are ten colours
    axis.step(
        [sizes[0], *sizes], above, style, where="post", label=name, color=f"C{number}", lw=1.4
    )
