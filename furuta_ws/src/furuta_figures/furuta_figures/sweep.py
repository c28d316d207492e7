"""Picture of a study: the arm's travel over its parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from furuta_studies.sweep_points import Axis

LABEL = "arm, peak to peak [rad]"


def draw(axes: tuple[Axis, ...], rows: list[dict[str, Any]], path: Path) -> None:
    """Two parameters as a plane of colours; otherwise a panel for each."""
    held = [row for row in rows if not row["error"] and not row["fell"]]
    lost = [row for row in rows if row["error"] or row["fell"]]
    if len(axes) == 2:
        figure, plane = plt.subplots(figsize=(7.5, 6), layout="constrained")
        first, second = axes
        points = plane.scatter(
            _values(first, held), _values(second, held), c=_sizes(held), s=60, marker="s"
        )
        if lost:
            plane.plot(
                _values(first, lost), _values(second, lost), "kx", label="fell, or impossible"
            )
            figure.legend(loc="outside lower center")
        figure.colorbar(points, label=LABEL)
        plane.set(xlabel=first.name, ylabel=second.name)
    else:
        figure, grid = plt.subplots(
            1,
            len(axes),
            figsize=(2.0 + 4.0 * len(axes), 4.5),
            squeeze=False,
            sharey=True,
            layout="constrained",
        )
        for axis, panel in zip(axes, grid[0], strict=True):
            _panel(panel, axis, held)
        grid[0, 0].set_ylabel(LABEL)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _panel(panel: Axes, axis: Axis, rows: list[dict[str, Any]]) -> None:
    panel.plot(_values(axis, rows), _sizes(rows), "o", ms=4, alpha=0.6)
    panel.set_xlabel(axis.name)
    panel.grid(alpha=0.3)


def _values(axis: Axis, rows: list[dict[str, Any]]) -> list[Any]:
    values = [row[axis.name] for row in rows]
    try:
        return [float(value) for value in values]
    except ValueError:
        return values


def _sizes(rows: list[dict[str, Any]]) -> np.ndarray:
    return np.array([row["phi_peak_to_peak_rad"] for row in rows])
