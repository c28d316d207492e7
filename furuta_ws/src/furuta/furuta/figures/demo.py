"""The demo's figure, like Figs 6 to 8 of the paper: arm, pendulum, control and friction."""

from __future__ import annotations

from pathlib import Path

from furuta.figures.figure import (
    ARM,
    CONTROL,
    ESTIMATE,
    FRICTION,
    PENDULUM,
    saved_figure,
    style_time_series,
)
from furuta.figures.run import SIGNALS
from furuta.studies.phases import Phase
from furuta_model.state import PHI, THETA
from furuta_recordings.bags.recorded_run import RecordedRun

TITLES = {
    "none": "no compensation (Fig. 6)",
    "coulomb": "Coulomb (Fig. 7)",
    "lugre": "LuGre (Fig. 8)",
    "tuned": "LuGre, tuned (Fig. 9)",
}
# The last part of each phase is shown [s].
SHOWN = 10.0


def draw_demo(recorded: RecordedRun, phases: list[Phase], path: Path) -> None:
    """Draw one column per phase and one row per signal; a row has one scale."""
    shape = (len(SIGNALS), len(phases))
    with saved_figure(path, *shape, sharex="col", sharey="row", figsize=(14, 8)) as (figure, axes):
        for column, phase in zip(axes.T, phases, strict=True):
            part = recorded.between(max(phase.start, phase.end - SHOWN), phase.end)
            column[0].set_title(TITLES[phase.compensation])
            column[0].plot(part.time, part.state[:, PHI], color=ARM, lw=1.2)
            column[1].plot(part.time, part.state[:, THETA], color=PENDULUM, lw=1.2)
            column[2].plot(part.time, part.command, color=CONTROL, lw=0.6)
            column[3].plot(
                part.time, part.friction, color=FRICTION, lw=2.4, alpha=0.7, label="true friction F"
            )
            column[3].plot(
                part.time, part.friction_estimate, color=ESTIMATE, lw=0.6, label="estimate of F"
            )
            column[3].set_xlabel("time [s]")
            for axis in column:
                style_time_series(axis)
        for axis, label in zip(axes[:, 0], SIGNALS, strict=True):
            axis.set_ylabel(label)
        figure.legend(*axes[3, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
