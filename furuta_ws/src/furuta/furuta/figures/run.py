"""One simulated run: arm, pendulum, control and friction over time."""

from __future__ import annotations

from pathlib import Path

from furuta.figures.figure import (
    ARM,
    CONTROL,
    ESTIMATE,
    FRICTION,
    PENDULUM,
    mark_half_turns,
    saved_figure,
    style_time_series,
)
from furuta_model.state import PHI, THETA
from furuta_sim.simulation.closed_loop import Record

# Labels of the four rows, also of the demo's and the experiments' figures.
SIGNALS = ("arm φ [rad]", "pendulum θ [rad]", "control u [V]", "friction [V]")


def draw_run(run: Record, path: Path) -> None:
    """Draw the four signals below each other."""
    with saved_figure(path, len(SIGNALS), sharex=True, figsize=(9, 8)) as (_, axes):
        axes[0].plot(run.time, run.state[:, PHI], color=ARM, lw=1.2)
        axes[1].plot(run.time, run.state[:, THETA], color=PENDULUM, lw=1.2)
        axes[2].plot(run.time, run.command, color=CONTROL, lw=0.8)
        axes[3].plot(run.time, run.friction, color=FRICTION, lw=1.6, label="true friction F")
        axes[3].plot(run.time, run.friction_estimate, color=ESTIMATE, lw=0.6, label="estimate of F")
        axes[3].legend(loc="upper right")
        axes[3].set_xlabel("time [s]")
        for axis, label in zip(axes, SIGNALS, strict=True):
            style_time_series(axis, label)
        mark_half_turns(axes[1])
