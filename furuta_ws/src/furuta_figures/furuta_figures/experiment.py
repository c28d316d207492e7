"""A figure of the paper: the rig's arm, pendulum, control and friction beside the ideal loop's."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

from furuta_figures.demo import LABELS
from furuta_model.state import PHI, THETA
from furuta_studies.experiments import ExperimentResult, sensor_resolution

# Seconds shown, the last ones.
SHOWN = 10.0


def draw_experiment(title: str, outcome: ExperimentResult, path: Path) -> None:
    """Four rows over the same time; the encoder's steps as a scale in the first."""
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(9, 8), layout="constrained")
    rig, ideal = outcome.rig, outcome.ideal
    # From the start where the two are compared in phase, else the settled motion.
    shown = (
        slice(None, round(SHOWN / rig.sample_time))
        if "simulation" in title
        else slice(-round(SHOWN / rig.sample_time), None)
    )
    time = rig.time[shown]
    axes[0].plot(time, ideal.state[shown, PHI], color="0.65", lw=2.0, label="perfect sensors")
    axes[0].plot(time, rig.state[shown, PHI], lw=1.2, label="rig")
    axes[1].plot(time, ideal.state[shown, THETA], color="0.65", lw=2.0)
    axes[1].plot(time, rig.state[shown, THETA], lw=1.2)
    axes[2].plot(time, rig.command[shown], lw=0.8)
    axes[3].plot(time, rig.friction[shown], lw=1.6, color="C1", label="true friction F")
    axes[3].plot(time, rig.friction_estimate[shown], lw=0.6, color="C2", label="estimate of F")
    count = sensor_resolution(outcome.loop)
    axes[0].set_title(
        f"{title}\narm {outcome.measured.phi_peak_to_peak_rad:.4f} rad peak to peak, predicted "
        f"{outcome.predicted_phi_peak_to_peak_rad:.4f}, one encoder count {count:.4f}"
    )
    for axis, label in zip(axes, LABELS, strict=True):
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
        axis.margins(x=0)
    axes[3].set_xlabel("time [s]")
    figure.legend(loc="outside lower center", ncols=4)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)
