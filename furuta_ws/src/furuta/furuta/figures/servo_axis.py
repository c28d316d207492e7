"""A servo axis: its exact motion, simulated errors, and the friction of a fit."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from furuta.axis.simulation import AxisRecord
from furuta.figures.figure import (
    ARM,
    ESTIMATE,
    REFERENCE,
    VOLTAGE,
    axes_for,
    numbered_axes,
    style_axis,
    style_time_series,
)
from furuta.figures.friction import draw_followed, draw_law
from furuta.figures.limit_cycle import draw_cycle
from furuta.identification.result.friction_curve import Followed, FrictionCurve
from furuta.limit_cycles.periodic_orbit import Trajectory
from furuta_model.state import PHI

# Periods of a cycle that are drawn.
PERIODS = 2
# Places of the axes in rows: the error, position, forces and phase plane of a cycle; the error
# alone; friction, position and residual of a fit, which come after these.
CYCLE, ALONE, FIT = [[1, 0], [2, 3]], [[0, 0]], [[0, 1], [0, 2]]


def draw_axis(
    motion: Trajectory | None,
    runs: Mapping[str, AxisRecord],
    units: tuple[str, str],
    title: str,
    fit: tuple[FrictionCurve, Followed] | None,
    axes: Any = None,
) -> Any:
    """Draw an exact cycle, the second half of runs by name, and what was identified.

    ``units`` are those of position and torque.
    """
    position_unit, torque_unit = units
    drive = "force" if torque_unit == "N" else "torque"
    rows = ALONE if motion is None else CYCLE
    first = 1 + max(map(max, rows))
    if fit is not None:
        rows = rows + [[first + place for place in row] for row in FIT]
    axes = numbered_axes(axes, rows, figsize=(10, 3.25 * len(rows)))
    after = axes[0]
    if motion is not None:
        position, force, plane = axes[1:4]
        state = motion.state.copy()
        state[:, PHI] -= 0.5 * (np.min(state[:, PHI]) + np.max(state[:, PHI]))
        names = (drive, "friction")
        draw_cycle(position, force, plane, motion._replace(state=state), PERIODS, names)
        style_axis(position, y=f"exact: position [{position_unit}]")
        style_axis(force, "time [s]", f"{drive} [{torque_unit}]")
        style_axis(plane, f"position [{position_unit}]", f"speed [{position_unit}/s]")
    for (name, run), colour in zip(runs.items(), (REFERENCE, ESTIMATE), strict=False):
        settled = slice(len(run.time) // 2, None)
        time, error = run.time[settled] - run.time[settled.start], run.error[settled]
        after.plot(time, error, color=colour, label=name)
    if runs:
        after.margins(y=0.3)
        after.legend()
    style_axis(after, "time [s]", f"simulated: error [{position_unit}]")
    if fit is not None:
        curve, followed = fit
        draw_law(axes[first], curve)
        draw_followed(axes[first + 1], axes[first + 2], followed)
    axes[0].figure.suptitle(title)
    return np.array(axes)


def draw_run(run: AxisRecord, axes: Any = None) -> Any:
    """Draw error and torque of a simulated axis over time."""
    _, axes = axes_for(axes, 2, sharex=True, figsize=(9, 5))
    axes[0].plot(run.time, run.error, lw=0.9, color=ARM)
    axes[1].plot(run.time, run.torque, lw=0.7, color=VOLTAGE)
    style_time_series(axes[0], "error [rad]")
    style_time_series(axes[1], "torque [N m]")
    axes[1].set_xlabel("time [s]")
    return axes
