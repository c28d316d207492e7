"""Exact limit cycles: one period, and a branch over a parameter."""

from pathlib import Path
from typing import Any

import numpy as np

from furuta.figures.figure import ARM, CONTROL, FRICTION, PENDULUM, saved_figure, style_axis
from furuta.figures.labels import axis_label
from furuta.limit_cycles.continuation import BranchPoint
from furuta.limit_cycles.periodic_orbit import LimitCycle, Trajectory
from furuta_model.state import PHI, PHI_DOT, THETA

# Fields of a limit cycle that are drawn along a branch, with their labels and colours.
BRANCH_SERIES = {
    "phi_peak_to_peak_rad": ("arm, peak to peak [rad]", ARM),
    "period_s": ("period [s]", "0.3"),
}

# Events of a branch that are marked, with their labels.
MARKED_EVENTS = {"fold": "fold", "vanishes": "the cycle vanishes"}


def draw_limit_cycle(motion: Trajectory, cycle: LimitCycle, law: str, path: Path) -> None:
    """Draw arm, pendulum, control and friction over one period, and the arm's phase plane."""
    with saved_figure(path, 2, 2, figsize=(10, 6.5)) as (figure, axes):
        (arm, pendulum), (force, plane) = axes
        arm.plot(motion.time, motion.state[:, PHI], color=ARM)
        style_axis(arm, y="arm φ [rad]")
        pendulum.plot(motion.time, motion.state[:, THETA], color=PENDULUM)
        style_axis(pendulum, y="pendulum θ [rad]")
        force.plot(motion.time, motion.control, color=CONTROL, label="control u")
        force.plot(motion.time, motion.friction, color=FRICTION, label="friction F")
        style_axis(force, "time [s]", "[V]")
        force.legend()
        plane.plot(motion.state[:, PHI], motion.state[:, PHI_DOT], color=ARM)
        style_axis(plane, "arm φ [rad]", "arm speed [rad/s]")
        figure.suptitle(_title(law, cycle))


def _title(law: str, cycle: LimitCycle) -> str:
    return (
        f"{law}: {cycle.phi_peak_to_peak_rad:.4f} rad, {cycle.period_s:.3f} s, stuck "
        f"{cycle.stuck_fraction:.0%}, {'stable' if cycle.stable else 'unstable'}, largest "
        f"multiplier {abs(cycle.floquet_multipliers[0]):.3g}"
    )


def draw_branch(name: str, points: list[BranchPoint], path: Path) -> None:
    """Draw amplitude and period along the branch: unstable cycles dashed, events marked."""
    with saved_figure(path, len(BRANCH_SERIES), sharex=True, figsize=(8, 7)) as (_, axes):
        for axis, (field, (label, colour)) in zip(axes, BRANCH_SERIES.items(), strict=True):
            _draw_branch_series(axis, points, field, colour)
            style_axis(axis, y=label)
        axes[0].legend()
        _label_events(axes[0], name, points)
        axes[-1].set_xlabel(axis_label(name))


def _draw_branch_series(axis: Any, points: list[BranchPoint], field: str, colour: str) -> None:
    values = np.array([point.value for point in points])
    stable = np.array([point.cycle.stable for point in points])
    heights = np.array([getattr(point.cycle, field) for point in points])
    axis.plot(values, np.where(stable, heights, np.nan), "-", color=colour, label="stable")
    axis.plot(values, np.where(stable, np.nan, heights), "--", color=colour, label="unstable")
    for point in points:
        if point.event in MARKED_EVENTS:
            axis.plot(point.value, getattr(point.cycle, field), "ko", ms=5)


def _label_events(axis: Any, name: str, points: list[BranchPoint]) -> None:
    """Name each event and its value, on the side of the point that has more room."""
    middle = sum(axis.get_xlim()) / 2.0
    for point in points:
        if point.event in MARKED_EVENTS:
            right = point.value > middle
            axis.annotate(
                f"{MARKED_EVENTS[point.event]} at {axis_label(name).partition(' [')[0]} = "
                f"{point.value:.4g}",
                (point.value, point.cycle.phi_peak_to_peak_rad),
                xytext=(-10 if right else 10, 0),
                textcoords="offset points",
                ha="right" if right else "left",
                va="center",
            )
