"""Series over time: a recording or simulation, or a recorded session and its recomputation."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from furuta.figures.figure import (
    ARM,
    CONTROL,
    ESTIMATE,
    FRICTION,
    MEASURED,
    PENDULUM,
    saved_figure,
    style_time_series,
)
from furuta.studies.recomputation import Recomputed
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI_DOT, THETA, THETA_DOT
from furuta_recordings.bags.recorded_loop import RecordedLoop

# Columns that a row shows where they exist: label and style. The truth has the colour of its
# quantity.
COLUMNS: dict[str, dict[str, dict[str, Any]]] = {
    "arm φ [rad]": {
        "measured_phi_rad": {"label": "measured", "lw": 0.8, "color": MEASURED},
        "true_phi_rad": {"label": "true", "lw": 1.6, "color": ARM},
        "estimated_phi_rad": {"label": "estimated", "lw": 0.8, "color": ESTIMATE},
    },
    "pendulum θ [rad]": {
        "measured_theta_rad": {"label": "measured", "lw": 0.8, "color": MEASURED},
        "true_theta_rad": {"label": "true", "lw": 1.6, "color": PENDULUM},
        "estimated_theta_rad": {"label": "estimated", "lw": 0.8, "color": ESTIMATE},
    },
    "control u [V]": {"command_v": {"label": "command", "lw": 0.8, "color": CONTROL}},
    "friction [V]": {
        "true_friction_v": {"label": "true F", "lw": 1.6, "color": FRICTION},
        "friction_estimate_v": {"label": "friction estimate", "lw": 0.6, "color": ESTIMATE},
    },
}
# An interval longer than this many usual ones is a gap, over which no line is drawn.
GAP = 100.0
# Matplotlib finds no ticks for the largest numbers.
LARGEST = 1e100

# Label of each row, and its lines: values and style.
Rows = dict[str, list[tuple[np.ndarray, dict[str, Any]]]]


def draw_series(series: Mapping[str, np.ndarray], path: Path) -> None:
    """Draw the columns that exist, a row per quantity.

    Raises:
        ParameterError: There is nothing to draw, or a number is too large.
    """
    time = series["time_s"]
    interval = np.diff(time, prepend=time[0])
    after_gap = interval > GAP * np.median(interval)
    for name, values in series.items():
        largest = float(np.nanmax(np.abs(values), initial=0.0))
        if largest > LARGEST:
            raise ParameterError(f"{name} has {largest:.3g}, at most {LARGEST:g} can be drawn")
    rows: Rows = {}
    for label, columns in COLUMNS.items():
        lines = [
            (np.where(after_gap, np.nan, series[name]), style)
            for name, style in columns.items()
            if name in series
        ]
        if lines:
            rows[label] = lines
    if not rows:
        raise ParameterError(f"no series to draw in {path}")
    _draw(time, rows, path)


def draw_recomputation(recorded: RecordedLoop, recomputed: Recomputed, path: Path) -> None:
    """Draw each series as recorded and as recomputed."""

    def lines(name: str, column: int | None = None) -> list[tuple[np.ndarray, dict[str, Any]]]:
        both = (getattr(recorded, name), getattr(recomputed, name))
        old, new = (values if column is None else values[:, column] for values in both)
        return [(old, {"lw": 1.4, "label": "recorded"}), (new, {"lw": 0.8, "label": "recomputed"})]

    rows = {
        "arm speed [rad/s]": lines("estimate", PHI_DOT),
        "pendulum θ [rad]": lines("estimate", THETA),
        "pendulum speed [rad/s]": lines("estimate", THETA_DOT),
        "friction estimate [V]": lines("friction_estimate"),
        "command [V]": lines("command"),
    }
    _draw(recorded.time, rows, path)


def _draw(time: np.ndarray, rows: Rows, path: Path) -> None:
    shared: dict[str, Any] = {"squeeze": False, "sharex": True, "figsize": (10, 2 * len(rows))}
    with saved_figure(path, len(rows), **shared) as (_, axes):
        for axis, (label, lines) in zip(axes[:, 0], rows.items(), strict=True):
            for values, style in lines:
                axis.plot(time, values, **style)
            style_time_series(axis, label)
            if len(lines) > 1:
                axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        axes[-1, 0].set_xlabel("time [s]")
