"""The series of a recording or simulation: arm, pendulum, control and friction over time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from furuta.figures.figure import (
    ARM,
    CONTROL,
    ESTIMATE,
    FRICTION,
    MEASURED,
    PENDULUM,
    mark_half_turns,
    saved_figure,
    style_time_series,
)
from furuta_model.parameters import ParameterError

# Label of each row, and the columns that it shows where they exist: name, label, line width.
ROWS = (
    ("arm φ [rad]", (("measured_phi_rad", "measured", 0.8), ("true_phi_rad", "true", 1.6),
                     ("estimated_phi_rad", "estimated", 0.8))),
    ("pendulum θ [rad]", (("measured_theta_rad", "measured", 0.8),
                          ("true_theta_rad", "true", 1.6),
                          ("estimated_theta_rad", "estimated", 0.8))),
    ("control u [V]", (("command_v", "command", 0.8),)),
    ("friction [V]", (("true_friction_v", "true F", 1.6),
                      ("friction_estimate_v", "friction estimate", 0.6))),
)  # fmt: skip
# The truth has the colour of its quantity.
COLOURS = {
    "true_phi_rad": ARM,
    "true_theta_rad": PENDULUM,
    "command_v": CONTROL,
    "true_friction_v": FRICTION,
    "measured_phi_rad": MEASURED,
    "measured_theta_rad": MEASURED,
}


# An interval longer than this many usual ones is a gap, over which no line is drawn.
GAP = 100.0


def draw_series(series: Mapping[str, np.ndarray], path: Path) -> None:
    """Draw the columns that exist, a row per quantity.

    Raises:
        ParameterError: There is nothing to draw.
    """
    rows = [(label, [each for each in columns if each[0] in series]) for label, columns in ROWS]
    rows = [(label, columns) for label, columns in rows if columns]
    if not rows:
        raise ParameterError(f"no series to draw in {path}")
    size = (10, 2 * len(rows))
    time = series["time_s"]
    after_gap = np.diff(time, prepend=time[0]) > GAP * np.median(np.diff(time, prepend=time[0]))
    with saved_figure(path, len(rows), squeeze=False, sharex=True, figsize=size) as (_, axes):
        for axis, (label, columns) in zip(axes[:, 0], rows, strict=True):
            for name, source, width in columns:
                colour = COLOURS.get(name, ESTIMATE)
                values = np.where(after_gap, np.nan, series[name])
                axis.plot(time, values, lw=width, label=source, color=colour)
            style_time_series(axis, label)
            if label.startswith("pendulum"):
                mark_half_turns(axis)
            if len(columns) > 1:
                axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        axes[-1, 0].set_xlabel("time [s]")
