"""The phases of the demo: which compensation was active when, and the motion in each phase."""

from typing import Any, NamedTuple

import numpy as np

from furuta.oscillation import measure_oscillation
from furuta.outcomes import outcome
from furuta_recordings.bags.recorded_loop import RecordedRun
from furuta_sim.simulation.closed_loop import Loop

# Compensations of the demo, of which one is LuGre with tuned σ₁, and their figures in the paper.
TUNED = "tuned"
PHASES = {"none": "Fig. 6", "coulomb": "Fig. 7", "lugre": "Fig. 8", TUNED: "Fig. 9"}
PHASES["recommended"] = ""
# Simulated time [s], and values of σ₁ relative to the one of the settings, among which LuGre is
# tuned.
SECONDS = 60.0
SCALES = (0.5, 0.71, 1.0, 1.41, 2.0, 2.83)
# The end of each phase is measured: so long [s], but at most this part of it.
MEASURED_SECONDS, MEASURED_PART = 30.0, 0.75


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
        measured = min(MEASURED_SECONDS, MEASURED_PART * (phase.end - phase.start))
        settled = recorded.between(phase.end - measured, phase.end)
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
                "measured_seconds": measured,
                "wall_seconds": phase.wall_seconds,
            }
        )
    return rows


def tuned_sigma1(loop: Loop) -> float:
    """The σ₁ of the LuGre compensation that leaves the least swing in a simulation [V s/rad]."""
    observer = loop.observer._replace(compensation="lugre")

    def swing(sigma1: float) -> float:
        tuned = observer._replace(friction=observer.friction._replace(sigma1=sigma1))
        return outcome(loop._replace(observer=tuned), SECONDS).phi_peak_to_peak_rad

    return min((scale * observer.friction.sigma1 for scale in SCALES), key=swing)
