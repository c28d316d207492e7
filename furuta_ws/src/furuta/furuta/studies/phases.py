"""The phases of the demo: which compensation was active when, and the motion in each phase."""

from typing import Any, NamedTuple

import numpy as np

from furuta.oscillation import measure_oscillation
from furuta_recordings.bags.recorded_loop import RecordedRun

# The phases: the three compensations of the paper, LuGre with tuned σ₁, and the recommended one.
TUNED = "tuned"
COMPENSATIONS = ("none", "coulomb", "lugre", TUNED, "recommended")
# Part of each phase that is transient; the rest is evaluated.
TRANSIENT = 0.75


class Phase(NamedTuple):
    """One compensation, its start and end in pendulum time [s], and the time it took [s]."""

    compensation: str
    start: float
    end: float
    wall_seconds: float


def evaluate(phases: list[Phase], recorded: RecordedRun) -> list[dict[str, Any]]:
    """Amplitude, period, control effort and speed of each phase, from the recorded true state."""
    rows = []
    for phase in phases:
        settled = recorded.between(phase.start + TRANSIENT * (phase.end - phase.start), phase.end)
        oscillation = measure_oscillation(settled.state, float(np.diff(settled.time).mean()))
        rows.append(
            {
                "compensation": phase.compensation,
                "phi_peak_to_peak_rad": oscillation.phi_peak_to_peak_rad,
                "theta_peak_to_peak_rad": oscillation.theta_peak_to_peak_rad,
                "period_s": oscillation.period_s,
                "command_rms_v": float(np.sqrt(np.mean(settled.command**2))),
                "samples": len(recorded.between(phase.start, phase.end).time),
                "sim_seconds": phase.end - phase.start,
                "wall_seconds": phase.wall_seconds,
            }
        )
    return rows
