"""Map of the limit cycle's size over two parameters, predicted and exact."""

from typing import Any

import numpy as np
from matplotlib.colors import LogNorm

from furuta.figures.figure import axes_for, axis_label, legend_outside, style_axis
from furuta.studies.feedback_map import MapPoint

# Colours of motions that are no limit cycle.
OTHER_KINDS = {
    "rest": "#2ca02c",
    "steady": "#9467bd",
    "unbounded": "#7f7f7f",
    "fell": "#7f7f7f",
    "irregular": "#e377c2",
    "impossible": "#000000",
}


def draw_map(
    first: str,
    second: str,
    firsts: np.ndarray,
    seconds: np.ndarray,
    points: list[MapPoint],
    axes: Any = None,
) -> Any:
    """Draw the arm's peak-to-peak angle, predicted and exact, on one scale.

    Motions that are no limit cycle have a colour of their own.
    """
    shape = (len(firsts), len(seconds))
    kinds = np.array([p.kind for p in points]).reshape(shape).T
    exact = (
        np.array([p.cycle.phi_peak_to_peak_rad if p.cycle else np.nan for p in points])
        .reshape(shape)
        .T
    )
    predicted = np.array([p.predicted_phi_peak_to_peak_rad for p in points]).reshape(shape).T
    sizes = {
        "describing function": np.where(predicted > 0.0, predicted, np.nan),
        "exact": np.where(kinds == "limit_cycle", exact, np.nan),
    }
    scale = common_scale(np.concatenate(list(sizes.values())))
    figure, axes = axes_for(axes, 1, 2, sharey=True, figsize=(12, 5.5))
    for axis, (title, size) in zip(axes, sizes.items(), strict=True):
        mesh = axis.pcolormesh(firsts, seconds, size, norm=scale, shading="nearest")
        axis.set_title(title)
        style_axis(axis, axis_label(first))
    axes[0].set_ylabel(axis_label(second))
    bar = figure.colorbar(mesh, ax=axes, label="arm, peak to peak [rad]")
    style_axis(bar.ax)
    mark_other_kinds(axes[1], firsts, seconds, kinds)
    if (kinds != "limit_cycle").any():
        legend_outside(figure, "lower center", ncols=len(OTHER_KINDS))
    return axes


def common_scale(sizes: np.ndarray) -> LogNorm | None:
    """The logarithmic colour scale of all finite sizes, None if there are none."""
    finite = sizes[np.isfinite(sizes)]
    return LogNorm(finite.min(), finite.max()) if finite.size else None


def mark_other_kinds(axis: Any, firsts: np.ndarray, seconds: np.ndarray, kinds: np.ndarray) -> None:
    """Mark the points of :data:`OTHER_KINDS`."""
    column, row = np.meshgrid(firsts, seconds)
    for kind, colour in OTHER_KINDS.items():
        chosen = kinds == kind
        if chosen.any():
            axis.plot(column[chosen], row[chosen], "s", color=colour, ms=4, label=kind)
