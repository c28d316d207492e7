"""What all figures share: creation, saving, labels and grid."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator

from furuta_ros.whole_files import whole_file

DPI = 110
# Opacity of the grid; it is fainter behind curves in the complex plane.
GRID, FAINT_GRID = 0.3, 0.25
# One colour per quantity in all figures. The estimate of a quantity is thin and dark, its
# measurement and a reference are grey.
ARM, PENDULUM, CONTROL, FRICTION = "C0", "C1", "C2", "C3"
ESTIMATE, MEASURED, REFERENCE = "0.15", "0.6", "0.65"
# Multiples of π/2 are marked on an angle's axis that shows at least this [rad].
MARKED_ANGLE = 2.5


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
        with whole_file(path) as new:
            figure.savefig(new, dpi=dpi)
    finally:
        plt.close(figure)


def style_axis(axis: Axes, x: str = "", y: str = "", grid: float = GRID) -> None:
    """Set labels (an empty one is left out) and draw the grid."""
    if x:
        axis.set_xlabel(x)
    if y:
        axis.set_ylabel(y)
    axis.grid(alpha=grid)


def annotate(axis: Axes, point: tuple[float, float], text: str, **options: Any) -> None:
    """Write ``text`` in a box beside a point; ``options`` are those of matplotlib's annotate."""
    box = {"boxstyle": "round", "fc": "white", "ec": "0.8", "alpha": 0.9}
    axis.annotate(text, point, textcoords="offset points", bbox=box, zorder=5, **options)


def style_time_series(axis: Axes, y: str = "") -> None:
    """Set the label, draw the grid, and let the curve fill the width."""
    style_axis(axis, y=y)
    axis.margins(x=0)


def mark_half_turns(axis: Axes) -> None:
    """Mark multiples of π/2 or π on the vertical axis of an angle, if it shows half a turn."""
    low, high = axis.get_ylim()
    if max(abs(low), abs(high)) < MARKED_ANGLE:
        return
    step = np.pi / 2 if high - low < 3 * np.pi else np.pi * np.ceil((high - low) / (8 * np.pi))
    axis.yaxis.set_major_locator(MultipleLocator(step))
    axis.yaxis.set_major_formatter(FuncFormatter(_half_turns))


def _half_turns(angle: float, position: int | None = None) -> str:
    """An angle [rad] as a multiple of π/2: 0, π/2, −π, 3π/2."""
    halves = round(2.0 * angle / np.pi)
    sign = "−" if halves < 0 else ""
    number, half = abs(halves), abs(halves) % 2
    if number == 0:
        return "0"
    factor = number if half else number // 2
    return f"{sign}{'' if factor == 1 else factor}π{'/2' if half else ''}"
