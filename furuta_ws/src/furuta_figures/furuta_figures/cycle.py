"""Pictures of exact limit cycles: one period, a branch, a map."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from furuta_analysis.limit_cycles.continuation import BranchPoint
from furuta_analysis.limit_cycles.limit_cycle import LimitCycle, Trajectory
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_studies.feedback_map import StudyPoint


def draw_cycle(motion: Trajectory, cycle: LimitCycle, law: str, path: Path) -> None:
    """Arm, pendulum, control and friction over one period, and the arm's phase plane."""
    figure, axes = plt.subplots(2, 2, figsize=(10, 6.5), layout="constrained")
    (arm, pendulum), (force, plane) = axes
    arm.plot(motion.time, motion.state[:, PHI])
    arm.set(ylabel="arm φ [rad]")
    pendulum.plot(motion.time, motion.state[:, THETA])
    pendulum.set(ylabel="pendulum θ [rad]")
    force.plot(motion.time, motion.control, label="control u")
    force.plot(motion.time, motion.friction, label="friction F")
    force.set(xlabel="time [s]", ylabel="[V]")
    force.legend()
    plane.plot(motion.state[:, PHI], motion.state[:, PHI_DOT])
    plane.set(xlabel="arm φ [rad]", ylabel="arm speed [rad/s]")
    figure.suptitle(
        f"{law}: {cycle.phi_peak_to_peak_rad:.4f} rad, {cycle.period_s:.3f} s, stuck "
        f"{cycle.stuck_fraction:.0%}, {'stable' if cycle.stable else 'unstable'}, largest "
        f"multiplier {abs(cycle.floquet_multipliers[0]):.3g}"
    )
    _save(figure, path)


def draw_branch(name: str, points: list[BranchPoint], path: Path) -> None:
    """Amplitude and period along the branch; unstable cycles dashed, events marked."""
    figure, axes = plt.subplots(2, 1, sharex=True, figsize=(8, 7), layout="constrained")
    values = np.array([point.value for point in points])
    stable = np.array([point.cycle.stable for point in points])
    for axis, field, label in (
        (axes[0], "phi_peak_to_peak_rad", "arm, peak to peak [rad]"),
        (axes[1], "period_s", "period [s]"),
    ):
        heights = np.array([getattr(point.cycle, field) for point in points])
        axis.plot(values, np.where(stable, heights, np.nan), "C0-", label="stable")
        axis.plot(values, np.where(stable, np.nan, heights), "C3--", label="unstable")
        for point in points:
            if point.event in ("fold", "vanishes"):
                axis.plot(point.value, getattr(point.cycle, field), "ko", ms=5)
        axis.set_ylabel(label)
    axes[0].legend()
    axes[1].set_xlabel(name)
    _save(figure, path)


# Colours of what is no oscillation.
KINDS = {
    "rest": "#2ca02c",
    "rotation": "#9467bd",
    "unbounded": "#7f7f7f",
    "irregular": "#e377c2",
    "impossible": "#000000",
}


def draw_map(
    first: str,
    second: str,
    firsts: np.ndarray,
    seconds: np.ndarray,
    points: list[StudyPoint],
    path: Path,
) -> None:
    """Arm's travel over two parameters, predicted and exact, on one scale; other ends by colour."""
    figure, axes = plt.subplots(1, 2, sharey=True, figsize=(12, 5.5), layout="constrained")
    shape = (len(firsts), len(seconds))
    kinds = np.array([p.cycle.kind for p in points]).reshape(shape).T
    exact = np.array([p.cycle.phi_peak_to_peak_rad for p in points]).reshape(shape).T
    predicted = np.array([p.predicted_phi_peak_to_peak_rad for p in points]).reshape(shape).T
    sizes = (
        np.where(predicted > 0.0, predicted, np.nan),
        np.where(kinds == "oscillation", exact, np.nan),
    )
    drawn = np.concatenate(sizes)
    drawn = drawn[np.isfinite(drawn)]
    # Where nothing oscillates there is no size to scale by.
    scale = LogNorm(drawn.min(), drawn.max()) if drawn.size else None
    for axis, size, title in zip(axes, sizes, ("describing function", "exact"), strict=True):
        mesh = axis.pcolormesh(firsts, seconds, size, norm=scale, shading="nearest")
        axis.set(xlabel=first, title=title)
    axes[0].set_ylabel(second)
    figure.colorbar(mesh, ax=axes, label="arm, peak to peak [rad]")
    column, row = np.meshgrid(firsts, seconds)
    for kind, colour in KINDS.items():
        chosen = kinds == kind
        if chosen.any():
            axes[1].plot(column[chosen], row[chosen], "s", color=colour, ms=4, label=kind)
    if (kinds != "oscillation").any():
        figure.legend(loc="outside lower center", ncols=len(KINDS))
    _save(figure, path)


def _save(figure: Figure, path: Path) -> None:
    for axis in figure.axes:
        axis.grid(alpha=0.3)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)
