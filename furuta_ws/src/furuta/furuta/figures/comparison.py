"""Figure of a comparison: the residuals of each candidate."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from furuta.figures.figure import axes_for, legend_outside, scale_sizes, style_axis
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
    """Draw a point per rig for each candidate in ``order``, their median, 95 % and the worst."""
    finite = table.residual[np.isfinite(table.residual)]
    fall = FALL * float(finite.max(initial=1.0))
    figure, axis = axes_for(axes, figsize=(9, max(2.0 + 0.55 * len(order), 4.5)))
    for number, name in enumerate(order):
        residual = table.residual[table.candidates.index(name)]
        _draw_points(axis, number, np.where(np.isinf(residual), fall, residual))
    axis.set_yticks(range(len(order)), order)
    axis.invert_yaxis()
    axis.axvline(encoder_count, color="0.3", ls="--", lw=1, label=COUNT)
    scale_sizes(axis, "x", [*finite, fall])
    if np.isinf(table.residual).any():
        axis.axvline(fall, color="tab:red", lw=0.8, label="fell")
    axis.plot([], [], "k|", ms=12, label="median, 95 %, worst")
    legend_outside(figure, "lower center", *axis.get_legend_handles_labels(), ncols=3)
    axis.set_title(f"{len(table.rigs)} rigs")
    style_axis(axis, LABEL)
    return axis


def _draw_points(axis: Axes, number: int, residual: np.ndarray) -> None:
    scatter = np.random.default_rng(number).uniform(-SCATTER, SCATTER, len(residual))
    some = slice(None, MOST_POINTS)
    axis.plot(residual[some], number + scatter[some], ".", ms=4, alpha=0.5, color=f"C{number}")
    marks = np.quantile(residual, [0.5, 0.95, 1.0], method="inverted_cdf")
    axis.plot(marks, [number] * 3, "k|", ms=16, mew=1.5)
