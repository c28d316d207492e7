"""Figure of a sweep: the arm's peak-to-peak angle over the swept parameters."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from furuta.figures.figure import saved_figure, style_axis
from furuta.figures.labels import axis_label
from furuta.studies.sweep_points import SweptParameter

LABEL = "arm, peak to peak [rad]"
Rows = list[dict[str, Any]]


def draw_sweep(parameters: tuple[SweptParameter, ...], rows: Rows, path: Path) -> None:
    """Draw two parameters as a plane of colours, otherwise one panel per parameter.

    If one of two parameters is a choice, such as the compensation, each of its values is a line.
    """
    finished = [row for row in rows if not row["error"] and not row["fell"]]
    failed = [row for row in rows if row["error"] or row["fell"]]
    choices = [parameter for parameter in parameters if _is_choice(parameter)]
    if len(parameters) == 2 and len(choices) == 1:
        (choice,) = choices
        (number,) = (parameter for parameter in parameters if parameter is not choice)
        _draw_lines(number, choice, finished, path)
    elif len(parameters) == 2:
        _draw_plane(*parameters, finished, failed, path)
    else:
        _draw_panels(parameters, finished, path)


def _is_choice(parameter: SweptParameter) -> bool:
    """Whether its values are words."""
    return not all(_is_number(value) for value in parameter.values)


def _is_number(value: Any) -> bool:
    try:
        float(value)
    except ValueError:
        return False
    return True


def _draw_lines(number: SweptParameter, choice: SweptParameter, finished: Rows, path: Path) -> None:
    with saved_figure(path, figsize=(8, 5)) as (figure, axis):
        for value in choice.values:
            chosen = [row for row in finished if str(row[choice.name]) == str(value)]
            if chosen:
                chosen.sort(key=lambda row: float(row[number.name]))
                axis.plot(_values(number, chosen), _sizes(chosen), ".-", label=str(value))
        axis.set_yscale("log")
        style_axis(axis, axis_label(number.name), LABEL)
        figure.legend(loc="outside right upper", title=choice.name.rpartition(".")[2])


def _draw_plane(
    first: SweptParameter, second: SweptParameter, finished: Rows, failed: Rows, path: Path
) -> None:
    with saved_figure(path, figsize=(7.5, 6)) as (figure, plane):
        points = plane.scatter(
            _values(first, finished),
            _values(second, finished),
            c=_sizes(finished),
            s=60,
            marker="s",
        )
        if failed:
            x, y = _values(first, failed), _values(second, failed)
            plane.plot(x, y, "kx", label="fell, or impossible")
            figure.legend(loc="outside lower center")
        figure.colorbar(points, label=LABEL)
        plane.set(xlabel=axis_label(first.name), ylabel=axis_label(second.name))


def _draw_panels(parameters: tuple[SweptParameter, ...], finished: Rows, path: Path) -> None:
    columns = len(parameters)
    size = (2.0 + 4.0 * columns, 4.5)
    with saved_figure(path, 1, columns, figsize=size, squeeze=False, sharey=True) as (_, panels):
        for parameter, panel in zip(parameters, panels[0], strict=True):
            _draw_panel(panel, parameter, finished)
        panels[0, 0].set_ylabel(LABEL)


def _draw_panel(panel: Axes, parameter: SweptParameter, rows: Rows) -> None:
    panel.plot(_values(parameter, rows), _sizes(rows), "o", ms=4, alpha=0.6)
    style_axis(panel, axis_label(parameter.name))


def _values(parameter: SweptParameter, rows: Rows) -> list[Any]:
    """The parameter's values: numbers if all are numbers, otherwise text."""
    values = [row[parameter.name] for row in rows]
    return [float(value) for value in values] if all(map(_is_number, values)) else values


def _sizes(rows: Rows) -> np.ndarray:
    return np.array([row["phi_peak_to_peak_rad"] for row in rows])
