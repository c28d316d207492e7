"""What all figures share: creation, saving, labels and grid."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

DPI = 110
# Opacity of the grid; it is fainter behind curves in the complex plane.
GRID, FAINT_GRID = 0.3, 0.25


@contextmanager
def saved_figure(
    path: Path, rows: int = 1, columns: int = 1, *, dpi: int = DPI, **options: Any
) -> Iterator[tuple[Figure, Any]]:
    """A figure and its axes to draw on, written to ``path`` at the end of the ``with`` block.

    ``options`` are those of :func:`matplotlib.pyplot.subplots`. The directory is created. Nothing
    is written after an exception.
    """
    figure, axes = plt.subplots(rows, columns, layout="constrained", **options)
    try:
        yield figure, axes
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=dpi)
    finally:
        plt.close(figure)


def style_axis(axis: Axes, x: str = "", y: str = "", grid: float = GRID) -> None:
    """Set labels (an empty one is left out) and draw the grid."""
    if x:
        axis.set_xlabel(x)
    if y:
        axis.set_ylabel(y)
    axis.grid(alpha=grid)


def style_time_series(axis: Axes, y: str = "") -> None:
    """Set the label, draw the grid, and let the curve fill the width."""
    style_axis(axis, y=y)
    axis.margins(x=0)
