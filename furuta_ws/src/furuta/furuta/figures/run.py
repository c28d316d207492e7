"""Runs over time: a simulation, an experiment of the paper, the demo's phases beside each other."""

from pathlib import Path
from typing import Any

from furuta.figures.figure import (
    ARM,
    CONTROL,
    ESTIMATE,
    FRICTION,
    PENDULUM,
    REFERENCE,
    mark_half_turns,
    saved_figure,
    style_time_series,
)
from furuta.studies.experiments import ExperimentResult, encoder_resolution
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
}
# Length of the part that is shown of an experiment, and of each phase of the demo [s].
SHOWN = 10.0


def draw_run(run: Record, path: Path) -> None:
    """Draw the four signals of a simulation below each other."""
    with saved_figure(path, len(SIGNALS), sharex=True, figsize=(9, 8)) as (_, axes):
        _draw_signals(axes, run)
        _label(axes)
        axes[3].legend(loc="upper right")


def draw_experiment(title: str, result: ExperimentResult, path: Path) -> None:
    """Draw the signals of the rig, and arm and pendulum of the loop with perfect sensors."""
    rig, reference = result.rig, result.perfect_sensors
    samples = round(SHOWN / rig.sample_time)
    # Rig and simulation are compared from the start, in phase; otherwise the settled motion counts.
    shown = slice(None, samples) if "simulation" in title else slice(-samples, None)
    with saved_figure(path, len(SIGNALS), sharex=True, figsize=(9, 8)) as (_, axes):
        for axis, index in zip(axes, (PHI, THETA), strict=False):
            values = reference.state[shown, index]
            axis.plot(rig.time[shown], values, color=REFERENCE, lw=2, label="perfect sensors")
        _draw_signals(axes, rig, shown)
        _label(axes)
        axes[0].set_title(
            f"{title}\narm {result.measured.phi_peak_to_peak_rad:.4f} rad peak to peak, predicted "
            f"{result.predicted_phi_peak_to_peak_rad:.4f}, one encoder count "
            f"{encoder_resolution(result.loop):.4f}"
        )
        for axis in axes[[0, 1, 3]]:
            axis.legend(loc="upper right", ncols=2)


def draw_demo(recorded: RecordedRun, phases: list[Phase], path: Path) -> None:
    """Draw one column per phase and one row per signal; a row has one scale."""
    shape = (len(SIGNALS), len(phases))
    with saved_figure(path, *shape, sharex="col", sharey="row", figsize=(14, 8)) as (figure, axes):
        for column, phase in zip(axes.T, phases, strict=True):
            _draw_signals(column, recorded.between(max(phase.start, phase.end - SHOWN), phase.end))
            column[0].set_title(TITLES[phase.compensation])
        _label(axes[:, 0])
        for axis in axes[-1]:
            axis.set_xlabel("time [s]")
        figure.legend(*axes[3, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)


def _draw_signals(axes: Any, run: Record | RecordedRun, shown: slice = slice(None)) -> None:
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


def _label(column: Any) -> None:
    for axis, label in zip(column, SIGNALS, strict=True):
        axis.set_ylabel(label)
    mark_half_turns(column[1])
    column[-1].set_xlabel("time [s]")
