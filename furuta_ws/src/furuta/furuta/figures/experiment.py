"""A figure of the paper: the signals of the rig, and of the same loop with perfect sensors."""

from __future__ import annotations

from pathlib import Path

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
from furuta.figures.run import SIGNALS
from furuta.studies.experiments import ExperimentResult, encoder_resolution
from furuta_model.state import PHI, THETA

# Length of the part that is shown [s].
SHOWN = 10.0


def draw_experiment(title: str, result: ExperimentResult, path: Path) -> None:
    """Draw the four signals below each other."""
    rig, reference = result.rig, result.perfect_sensors
    samples = round(SHOWN / rig.sample_time)
    # Rig and simulation are compared from the start, in phase; otherwise the settled motion counts.
    shown = slice(None, samples) if "simulation" in title else slice(-samples, None)
    time = rig.time[shown]
    with saved_figure(path, len(SIGNALS), sharex=True, figsize=(9, 8)) as (_, axes):
        for axis, index, colour in ((axes[0], PHI, ARM), (axes[1], THETA, PENDULUM)):
            axis.plot(
                time, reference.state[shown, index], color=REFERENCE, lw=2, label="perfect sensors"
            )
            axis.plot(time, rig.state[shown, index], color=colour, lw=1.2, label="rig")
        axes[2].plot(time, rig.command[shown], color=CONTROL, lw=0.8)
        axes[3].plot(
            time, rig.friction[shown], lw=2.4, alpha=0.7, color=FRICTION, label="true friction F"
        )
        axes[3].plot(
            time, rig.friction_estimate[shown], lw=0.6, color=ESTIMATE, label="estimate of F"
        )
        axes[0].set_title(f"{title}\n{_amplitudes(result)}")
        for axis, label in zip(axes, SIGNALS, strict=True):
            style_time_series(axis, label)
        mark_half_turns(axes[1])
        axes[3].set_xlabel("time [s]")
        for axis in axes[[0, 1, 3]]:
            axis.legend(loc="upper right", ncols=2)


def _amplitudes(result: ExperimentResult) -> str:
    return (
        f"arm {result.measured.phi_peak_to_peak_rad:.4f} rad peak to peak, predicted "
        f"{result.predicted_phi_peak_to_peak_rad:.4f}, one encoder count "
        f"{encoder_resolution(result.loop):.4f}"
    )
