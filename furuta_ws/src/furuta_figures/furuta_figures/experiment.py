"""A figure of the paper: the signals of the rig, and of the same loop with perfect sensors."""

from __future__ import annotations

from pathlib import Path

from furuta_figures.figure import saved_figure, style_time_series
from furuta_figures.run import SIGNALS
from furuta_model.state import PHI, THETA
from furuta_studies.experiments import ExperimentResult, encoder_resolution

# Length of the part that is shown [s].
SHOWN = 10.0


def draw_experiment(title: str, result: ExperimentResult, path: Path) -> None:
    """Draw the four signals below each other."""
    rig, reference = result.rig, result.perfect_sensors
    samples = round(SHOWN / rig.sample_time)
    # Rig and simulation are compared from the start, in phase; otherwise the settled motion counts.
    shown = slice(None, samples) if "simulation" in title else slice(-samples, None)
    time = rig.time[shown]
    with saved_figure(path, len(SIGNALS), sharex=True, figsize=(9, 8)) as (figure, axes):
        axes[0].plot(time, reference.state[shown, PHI], color="0.65", lw=2, label="perfect sensors")
        axes[0].plot(time, rig.state[shown, PHI], lw=1.2, label="rig")
        axes[1].plot(time, reference.state[shown, THETA], color="0.65", lw=2.0)
        axes[1].plot(time, rig.state[shown, THETA], lw=1.2)
        axes[2].plot(time, rig.command[shown], lw=0.8)
        axes[3].plot(time, rig.friction[shown], lw=1.6, color="C1", label="true friction F")
        axes[3].plot(time, rig.friction_estimate[shown], lw=0.6, color="C2", label="estimate of F")
        axes[0].set_title(f"{title}\n{_amplitudes(result)}")
        for axis, label in zip(axes, SIGNALS, strict=True):
            style_time_series(axis, label)
        axes[3].set_xlabel("time [s]")
        figure.legend(loc="outside lower center", ncols=4)


def _amplitudes(result: ExperimentResult) -> str:
    return (
        f"arm {result.measured.phi_peak_to_peak_rad:.4f} rad peak to peak, predicted "
        f"{result.predicted_phi_peak_to_peak_rad:.4f}, one encoder count "
        f"{encoder_resolution(result.loop):.4f}"
    )
