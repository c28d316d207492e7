"""The demo's figure, in the manner of Figs 6 to 8: arm, pendulum, control, friction."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

from furuta_analysis.simulation.closed_loop import Record
from furuta_model.state import PHI, THETA
from furuta_recordings.bags.recorded_run import RecordedRun
from furuta_studies.demo import Phase

TITLES = {
    "none": "no compensation (Fig. 6)",
    "coulomb": "Coulomb (Fig. 7)",
    "lugre": "LuGre (Fig. 8)",
    "tuned": "LuGre, tuned (Fig. 9)",
}
LABELS = ("arm φ [rad]", "pendulum θ [rad]", "control u [V]", "friction [V]")
# Seconds shown of each phase, its last.
SHOWN = 10.0


def draw_run(run: Record, path: Path) -> None:
    """Arm, pendulum, control and friction of one simulated run."""
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(9, 8), layout="constrained")
    axes[0].plot(run.time, run.state[:, PHI], lw=1.2)
    axes[1].plot(run.time, run.state[:, THETA], lw=1.2)
    axes[2].plot(run.time, run.command, lw=0.8)
    axes[3].plot(run.time, run.friction, lw=1.6, label="true friction F")
    axes[3].plot(run.time, run.friction_estimate, lw=0.6, label="estimate of F")
    axes[3].legend(loc="upper right")
    axes[3].set_xlabel("time [s]")
    for axis, label in zip(axes, LABELS, strict=True):
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
        axis.margins(x=0)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw(recorded: RecordedRun, phases: list[Phase], path: Path) -> None:
    """One column per phase, one row per signal, each row with one scale."""
    figure, axes = plt.subplots(
        4, len(phases), sharex="col", sharey="row", figsize=(14, 8), layout="constrained"
    )
    for column, phase in zip(axes.T, phases, strict=True):
        part = recorded.between(max(phase.start, phase.end - SHOWN), phase.end)
        column[0].set_title(TITLES[phase.compensation])
        column[0].plot(part.time, part.state[:, PHI], lw=1.2)
        column[1].plot(part.time, part.state[:, THETA], lw=1.2)
        column[2].plot(part.time, part.command, lw=0.6)
        column[3].plot(part.time, part.friction, lw=1.6, label="true friction F")
        column[3].plot(part.time, part.friction_estimate, lw=0.6, label="estimate of F")
        column[3].set_xlabel("time [s]")
        for axis in column:
            axis.grid(alpha=0.3)
            axis.margins(x=0)
    for axis, label in zip(axes[:, 0], LABELS, strict=True):
        axis.set_ylabel(label)
    figure.legend(*axes[3, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)
