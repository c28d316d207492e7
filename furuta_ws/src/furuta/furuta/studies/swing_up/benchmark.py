"""The benchmark of swing-up on a rig: performance, robustness and time upright with knock-downs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta.studies.swing_up.disturbed_drive import DisturbedDrive, DisturbedRun, run_disturbed
from furuta.studies.swing_up.performance import Performance, performance
from furuta.studies.swing_up.rig_loop import UPRIGHT_ANGLE
from furuta.studies.swing_up.robustness import RUN_TIME, Robustness, cases, robustness, run_cases
from furuta_model.state import PHI, THETA
from furuta_sim.simulation.closed_loop import Loop

# The shipped rigs that see the hanging pendulum.
RIGS = ("paper_full_turn", "qube_servo_2", "odrive_furuta")

# Time of the run with knock-downs, and time between two [s].
UPTIME_RUN, KNOCK_DOWN_PERIOD = 60.0, 10.0


class Uptime(NamedTuple):
    """Time upright of 60 s [s], knock-downs, swing-ups after them, largest arm angle [rad]."""

    uptime_s: float
    knock_downs: int
    swing_ups: int
    arm_angle_rad: float


def benchmark(loop: Loop, seed: int) -> dict[str, Performance | Robustness | Uptime]:
    """All parts of the benchmark for a loop, each by name."""
    loop = loop._replace(plant=loop.plant._replace(seed=seed))
    chosen = cases(loop, seed)
    knocked = DisturbedDrive(knock_down_period=KNOCK_DOWN_PERIOD)
    return {
        "performance": performance(run_disturbed(loop, DisturbedDrive(), RUN_TIME), loop),
        "robustness": robustness(chosen, run_cases(chosen)),
        "uptime": uptime(run_disturbed(loop, knocked, UPTIME_RUN)),
    }


def uptime(run: DisturbedRun) -> Uptime:
    """How long the pendulum is upright in a run with knock-downs."""
    up = np.cos(run.state[:, THETA]) > np.cos(UPRIGHT_ANGLE)
    period = round(KNOCK_DOWN_PERIOD / run.sample_time)
    parts = [up[first : first + period] for first in range(period, len(up), period)]
    return Uptime(
        float(np.sum(up)) * run.sample_time,
        sum(not np.all(part) for part in parts),
        sum(not np.all(part) and bool(part[-1]) for part in parts),
        float(np.max(np.abs(run.state[:, PHI]))),
    )
