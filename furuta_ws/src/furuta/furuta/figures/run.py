"""Runs over time: a simulation, the demo's phases beside each other."""

from pathlib import Path
from typing import Any

from furuta.figures.figure import (
    ARM,
    CONTROL,
    ESTIMATE,
    FRICTION,
    PENDULUM,
    legend_outside,
    saved_figure,
    style_time_series,
)
from furuta.studies.phases import Phase
from furuta_model.state import PHI, THETA
from furuta_recordings.bags.recorded_loop import RecordedRun
from furuta_sim.simulation.closed_loop import Record

# Labels of the rows.
SIGNALS = ("arm φ [rad]", "pendulum θ [rad]", "control u [V]", "friction [V]")
TITLES = {
    "none": "no compensation (Fig. 6)",
    "coulomb": "Coulomb (Fig. 7)",
    "lugre": "LuGre (Fig. 8)",
    "tuned": "LuGre, tuned (Fig. 9)",
    "recommended": "recommended",
}
# Length of the part that is shown of each phase of the demo, and of its friction [s].
SHOWN, FRICTION_SHOWN = 10.0, 2.5


def draw_run(run: Record, path: Path) -> None:
    """Draw the four signals of a simulation below each other."""
    with saved_figure(path, len(SIGNALS), sharex=True, figsize=(9, 8)) as (_, axes):
        draw_signals(axes, run)
        label_signals(axes)
        axes[3].legend(loc="upper right")


def draw_demo(recorded: RecordedRun, phases: list[Phase], path: Path) -> None:
    """Draw one column per phase and one row per signal; a row has one scale.

    The friction is shown for a shorter time, so that its estimate can be told from it.
    """
    shape = (len(SIGNALS), len(phases))
    with saved_figure(path, *shape, sharey="row", figsize=(17, 8.5)) as (figure, axes):
        for column, phase in zip(axes.T, phases, strict=True):
            draw_signals(column, recorded.between(max(phase.start, phase.end - SHOWN), phase.end))
            column[0].set_title(TITLES[phase.compensation])
            column[3].set_xlim(phase.end - FRICTION_SHOWN, phase.end)
            for axis in column[:2]:
                axis.tick_params(labelbottom=False)
        label_signals(axes[:, 0])
        for axis in axes[2:].flat:
            axis.set_xlabel("time [s]")
        entries = axes[3, 0].get_legend_handles_labels()
        legend_outside(figure, "lower center", *entries, ncols=2)


def draw_signals(axes: Any, run: Record | RecordedRun, shown: slice = slice(None)) -> None:
    """Draw arm, pendulum, control and friction on four axes."""
    for axis, values, style in zip(
        axes[[0, 1, 2, 3, 3]],
        (run.state[:, PHI], run.state[:, THETA], run.command, run.friction, run.friction_estimate),
        (
            {"color": ARM, "lw": 1.2, "label": "rig"},
            {"color": PENDULUM, "lw": 1.2, "label": "rig"},
            {"color": CONTROL, "lw": 0.8},
            {"color": FRICTION, "lw": 2.4, "alpha": 0.7, "label": "true friction F"},
            {"color": ESTIMATE, "lw": 0.6, "label": "estimate of F"},
        ),
        strict=True,
    ):
        axis.plot(run.time[shown], values[shown], **style)
        style_time_series(axis)


def label_signals(column: Any) -> None:
    """Label the four axes."""
    for axis, label in zip(column, SIGNALS, strict=True):
        axis.set_ylabel(label)
    column[-1].set_xlabel("time [s]")
