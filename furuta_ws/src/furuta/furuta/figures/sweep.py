"""Figure of a sweep: the arm's swing over the parameters, as curves or as a map."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from furuta.figures.feedback_map import common_scale, mark_other_kinds
from furuta.figures.figure import axes_for, axis_label, legend_outside, scale_sizes, style_axis
from furuta_model.parameters import ParameterError

LABEL = "arm, peak to peak [rad]"
# Most curves that can be told apart.
MOST_CURVES = 10
# Marks at the upper edge of runs that have no swing.
MARKS = {"fell": "v", "impossible": "x"}


def draw_runs(runs: Mapping[str, np.ndarray], names: Sequence[str], axes: Any = None) -> Any:
    """Draw curves over the parameter with most values, or a map if there were too many.

    Raises:
        ParameterError: Too many parameters have too many values.
    """
    values = {name: _numbers(runs[name]) for name in names}
    first = max(names, key=lambda name: (_is_number(values[name]), len(np.unique(values[name]))))
    others = [name for name in names if name != first]
    curves = list(dict.fromkeys(zip(*(values[name].tolist() for name in others), strict=True)))
    size = np.where(runs["fell"] == 1, np.nan, runs["phi_peak_to_peak_rad"]).astype(float)
    kinds = np.select([runs["error"] != "", runs["fell"] == 1], ["impossible", "fell"], "")
    figure, axis = axes_for(axes, figsize=(8, 5))
    if len(curves) <= MOST_CURVES:
        for curve in curves or [()]:
            chosen = np.full(len(size), True)
            for name, value in zip(others, curve, strict=True):
                chosen &= values[name] == value
            label = ", ".join(map(_label, others, curve))
            style = ".-" if _is_number(values[first]) else "o"
            axis.plot(values[first][chosen], size[chosen], style, label=label or None)
        for kind, marker in MARKS.items():
            there = values[first][kinds == kind]
            height, place = np.full(len(there), 0.98), axis.get_xaxis_transform()
            if len(there):
                axis.plot(there, height, marker, color="0.3", transform=place, label=kind)
        scale_sizes(axis, "y", size)
        style_axis(axis, axis_label(first), LABEL)
        if others or axis.get_legend_handles_labels()[1]:
            axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small")
        return axis
    if len(others) > 1 or not _is_number(values[others[0]]):
        raise ParameterError(
            f"a figure has at most {MOST_CURVES} curves, or a map over two numbers; given "
            f"{len(curves)} combinations of {', '.join(others)}"
        )
    places = values[first], values[others[0]]
    x, y = map(np.unique, places)
    order = np.lexsort(places)
    shape = len(y), len(x)
    mesh = axis.pcolormesh(
        x, y, size[order].reshape(shape), norm=common_scale(size), shading="nearest"
    )
    style_axis(figure.colorbar(mesh, ax=axis, label=LABEL).ax)
    mark_other_kinds(axis, x, y, kinds[order].reshape(shape))
    if kinds.any():
        legend_outside(figure, "lower center", ncols=2)
    style_axis(axis, axis_label(first), axis_label(others[0]))
    return axis


def _numbers(column: np.ndarray) -> np.ndarray:
    """The column as numbers if it is one of them, also as text; else as text."""
    try:
        return np.asarray(column, float)
    except ValueError:
        return np.asarray(column, str)


def _is_number(values: np.ndarray) -> bool:
    return values.dtype.kind == "f"


def _label(name: str, value: Any) -> str:
    symbol = axis_label(name).partition(" [")[0]
    return value if isinstance(value, str) else f"{symbol} = {value:.4g}"
