"""What all figures share: creation, saving, labels and grid; symbols of the parameters."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from furuta.loops import GAINS
from furuta.quantities import QUANTITIES
from furuta.settings.parameter_names import parameters_named
from furuta_model.parameters import ParameterError
from furuta_ros.whole_files import whole_file

DPI = 110
# Sizes that differ by more than this factor are drawn on a logarithmic scale.
WIDE = 5.0
# Opacity of the grid; it is fainter behind curves in the complex plane.
GRID, FAINT_GRID = 0.3, 0.25
# One colour per quantity in all figures. The estimate of a state is thin and dark, its measurement
# and a reference are grey.
ARM, PENDULUM, VOLTAGE, FRICTION, FRICTION_ESTIMATE = (
    QUANTITIES[name].light for name in ("arm", "pendulum", "command", "friction", "estimate")
)
ESTIMATE, MEASURED, REFERENCE = "0.15", "0.6", "0.65"

# By the last part of a parameter's name; a parameter without a symbol keeps its name.
SYMBOLS = {
    "alpha": "α",
    "beta": "β",
    "gamma": "γ",
    "delta": "δ",
    "alpha0": "α₀",
    "alpha1": "α₁",
    "stribeck_velocity": "vₛ",
    "sigma0": "σ₀",
    "sigma1": "σ₁",
    "viscous": "σ₂",
    "asymmetry": "a",
    "omega1": "ω₁",
    "zeta1": "ζ₁",
    "omega2": "ω₂",
    "zeta2": "ζ₂",
    "observer_gain": "K",
    "sample_time": "h",
    "a23": "a₂₃",
    "a43": "a₄₃",
    "b21": "b₂₁",
    "b41": "b₄₁",
}
# Gains of u = l·x, which are no parameters of a node.
GAIN_LABELS = dict(
    zip(GAINS, ("l₁ [V/rad]", "l₂ [V s/rad]", "l₃ [V/rad]", "l₄ [V s/rad]"), strict=True)
)


def axes_for(axes: Any, rows: int = 1, columns: int = 1, **options: Any) -> tuple[Figure, Any]:
    """The figure and the axes to draw on: those given, or new ones.

    ``options`` are those of :func:`matplotlib.pyplot.subplots`, and so is the shape of the axes.

    Raises:
        ParameterError: The axes given are not as many as needed.
    """
    if axes is None:
        return plt.subplots(rows, columns, layout="constrained", **options)
    given = np.ravel(axes)
    if given.size != rows * columns:
        raise ParameterError(f"the figure has {rows * columns} axes, given {given.size}")
    figure, shaped = given[0].figure, given.reshape(rows, columns)
    squeezed = shaped if options.get("squeeze") is False else np.squeeze(shaped)
    return figure, squeezed if squeezed.ndim else squeezed.item()


def numbered_axes(axes: Any, layout: Sequence[Sequence[int]], **options: Any) -> list[Axes]:
    """The axes given, or new ones that fill the places of their numbers in a layout of rows."""
    number = 1 + max(map(max, layout))
    if axes is not None:
        return list(np.ravel(axes_for(axes, number)[1]))
    _, places = plt.subplot_mosaic([list(row) for row in layout], layout="constrained", **options)
    return [places[k] for k in range(number)]


def save_figure(plot: Callable[[], Any], path: Path) -> None:
    """Draw with ``plot``, which returns axes, and write the figure; the folder is created.

    Nothing is written after an exception. No figure stays open, and no window opens.
    """
    matplotlib.use("Agg")
    open_before = set(plt.get_fignums())
    try:
        figure = np.ravel(plot())[0].figure
        with whole_file(path) as new:
            figure.savefig(new, dpi=DPI)
    finally:
        for number in set(plt.get_fignums()) - open_before:
            plt.close(number)


def legend_outside(figure: Figure, place: Any, *entries: Any, **options: Any) -> None:
    """A legend of the figure above or below its axes; ``place`` and ``options`` are matplotlib's.

    It is ``loc="outside ..."`` of matplotlib 3.7, for older ones too.
    """
    legend = figure.legend(*entries, loc=place, **options)
    engine: Any = figure.get_layout_engine()
    if not hasattr(engine, "set"):  # a figure of the user's own, with another layout
        return
    pad = 2.0 * engine.get()["h_pad"] / figure.get_figheight()
    height = legend.get_window_extent().height / figure.bbox.height + pad
    engine.set(rect=(0.0, height if "lower" in place else 0.0, 1.0, 1.0 - height))


def style_axis(axis: Axes, x: str = "", y: str = "", grid: float = GRID) -> None:
    """Set labels (an empty one is left out) and draw the grid."""
    if x:
        axis.set_xlabel(x)
    if y:
        axis.set_ylabel(y)
    axis.grid(alpha=grid)


def scale_sizes(axis: Axes, direction: str, sizes: Any) -> None:
    """Make the axis x or y of sizes logarithmic if they differ much, with marks at 1, 2 and 5."""
    known = np.asarray(sizes, float)
    known = known[np.isfinite(known) & (known > 0.0)]
    if not known.size or known.max() < WIDE * known.min():
        return
    axis.set(**{f"{direction}scale": "log"})
    marks = getattr(axis, f"{direction}axis")
    marks.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    marks.set_minor_locator(NullLocator())
    marks.set_major_formatter("{x:g}")


def annotate(axis: Axes, point: tuple[float, float], text: str, **options: Any) -> None:
    """Write ``text`` in a box beside a point; ``options`` are those of matplotlib's annotate."""
    box = {"boxstyle": "round", "fc": "white", "ec": "0.8", "alpha": 0.9}
    axis.annotate(text, point, textcoords="offset points", bbox=box, zorder=5, **options)


def style_time_series(axis: Axes, y: str = "") -> None:
    """Set the label, draw the grid, and let the curve fill the width."""
    style_axis(axis, y=y)
    axis.margins(x=0)


def axis_label(name: str) -> str:
    """Label of the axis of a parameter that is named as for ``--set``: symbol and unit.

    A name that restricts the parameter to a node or a group stays beside the symbol, so that the
    plant's α₀ is not taken for the observer's.
    """
    if name in GAIN_LABELS:
        return GAIN_LABELS[name]
    where, _, last = name.rpartition(".")
    symbol = SYMBOLS.get(last, last)
    (_, declared), *_ = parameters_named(name)
    unit = f" [{declared.about.unit}]" if declared.about.unit else ""
    if symbol == last:
        return f"{name}{unit}"
    return f"{symbol} of {where}{unit}" if where else f"{symbol}{unit}"
