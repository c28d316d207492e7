"""Exact limit cycles: one period of the pendulum or of an axis, and a branch over a parameter."""

from typing import Any

import numpy as np

from furuta.figures.figure import (
    ARM,
    FRICTION,
    PENDULUM,
    VOLTAGE,
    axes_for,
    style_axis,
)
from furuta.limit_cycles.continuation import BranchPoint
from furuta.limit_cycles.periodic_orbit import Trajectory
from furuta.quantities import QUANTITIES
from furuta_model.state import PHI, PHI_DOT, THETA

# Fields of a limit cycle that are drawn along a branch, of the arm or of a joint, with their labels
# and colours.
BRANCH_SERIES = {
    "phi_peak_to_peak_rad": ("arm, peak to peak [rad]", ARM),
    "peak_to_peak": ("position, peak to peak", ARM),
    "period_s": ("period [s]", "0.3"),
}

# Periods of an axis that are drawn.
PERIODS = 2
# Events of a branch that are marked, with their labels.
MARKED_EVENTS = {"fold": "fold", "vanishes": "the cycle vanishes"}


def draw_limit_cycle(motion: Trajectory, title: str, axes: Any = None) -> Any:
    """Draw arm, pendulum, control and friction over one period, and the arm's phase plane."""
    figure, axes = axes_for(axes, 2, 2, figsize=(10, 6.5))
    (arm, pendulum), (force, plane) = axes
    draw_cycle(arm, force, plane, motion)
    pendulum.plot(motion.time, motion.state[:, THETA], color=PENDULUM)
    style_axis(arm, y=QUANTITIES["arm"].axis)
    style_axis(pendulum, y=QUANTITIES["pendulum"].axis)
    style_axis(force, "time [s]", "[V]")
    style_axis(plane, QUANTITIES["arm"].axis, "arm speed [rad/s]")
    figure.suptitle(title)
    return axes


def draw_joint(motion: Trajectory, title: str, axes: Any = None) -> Any:
    """Draw position and forces of a friction joint over some periods, and the phase plane."""
    figure, axes = axes_for(axes, 1, 3, figsize=(12, 4))
    position, force, plane = axes
    draw_cycle(position, force, plane, motion, PERIODS, ("control", "friction"))
    style_axis(position, "time", "position")
    style_axis(force, "time", "force")
    style_axis(plane, "position", "speed")
    figure.suptitle(title)
    return axes


def draw_cycle(
    position: Any,
    force: Any,
    plane: Any,
    motion: Trajectory,
    periods: int = 1,
    names: tuple[str, str] = (QUANTITIES["command"].title, QUANTITIES["friction"].title),
) -> None:
    """Draw position and forces, which have names, over some periods, and the phase plane."""
    time = np.concatenate([motion.time + k * motion.time[-1] for k in range(periods)])
    phi, (control, friction) = motion.state[:, PHI], names
    position.plot(time, np.tile(phi, periods), color=ARM)
    force.plot(time, np.tile(motion.control, periods), color=VOLTAGE, label=control)
    force.plot(time, np.tile(motion.friction, periods), color=FRICTION, label=friction)
    force.legend()
    plane.plot(phi, motion.state[:, PHI_DOT], color=ARM)


def draw_branch(label: str, points: list[BranchPoint], axes: Any = None) -> Any:
    """Draw size and period along the branch: unstable cycles dashed, events marked.

    ``label`` is that of the parameter, with its unit.
    """
    fields = [field for field in BRANCH_SERIES if hasattr(points[0].cycle, field)]
    _, axes = axes_for(axes, len(fields), sharex=True, figsize=(8, 7))
    for axis, field in zip(axes, fields, strict=True):
        title, colour = BRANCH_SERIES[field]
        _draw_branch_series(axis, points, field, colour)
        style_axis(axis, y=title)
    axes[0].legend()
    _label_events(axes[0], label.partition(" [")[0], fields[0], points)
    axes[-1].set_xlabel(label)
    return axes


def _draw_branch_series(axis: Any, points: list[BranchPoint], field: str, colour: str) -> None:
    values = np.array([point.value for point in points])
    stable = np.array([point.cycle.stable for point in points])
    heights = np.array([getattr(point.cycle, field) for point in points])
    for chosen, line, label in ((stable, "-", "stable"), (~stable, "--", "unstable")):
        if chosen.any():
            axis.plot(values, np.where(chosen, heights, np.nan), line, color=colour, label=label)
    for point in points:
        if point.event in MARKED_EVENTS:
            axis.plot(point.value, getattr(point.cycle, field), "ko", ms=5)


def _label_events(axis: Any, symbol: str, field: str, points: list[BranchPoint]) -> None:
    """Name each event and its value, on the side of the point that has more room."""
    middle = sum(axis.get_xlim()) / 2.0
    for point in points:
        if point.event in MARKED_EVENTS:
            right = point.value > middle
            axis.annotate(
                f"{MARKED_EVENTS[point.event]} at {symbol} = {point.value:.4g}",
                (point.value, getattr(point.cycle, field)),
                xytext=(-10 if right else 10, 0),
                textcoords="offset points",
                ha="right" if right else "left",
                va="center",
            )
