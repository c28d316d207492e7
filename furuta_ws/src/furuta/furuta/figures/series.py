"""Series over time: a recording or simulation."""

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
from furuta_model.parameters import ParameterError

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
    rows: dict[str, list[tuple[np.ndarray, dict[str, Any]]]] = {}
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
    shared: dict[str, Any] = {"squeeze": False, "sharex": True, "figsize": (10, 2 * len(rows))}
    with saved_figure(path, len(rows), **shared) as (_, axes):
        for axis, (label, lines) in zip(axes[:, 0], rows.items(), strict=True):
            for values, style in lines:
                axis.plot(time, values, **style)
            style_time_series(axis, label)
            if len(lines) > 1:
                axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        axes[-1, 0].set_xlabel("time [s]")
