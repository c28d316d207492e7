"""The loop in mode ``swing_up`` on a rig, and when a run counts as upright within the limits."""

from math import cos, pi
from typing import Any, NamedTuple

import numpy as np

from furuta_hw.rigs.rig import Rig
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_sim.settings.settings import Settings, rig_settings
from furuta_sim.simulation.closed_loop import Loop, Record

# Pendulum angle [rad] within which it counts as upright: its tip is above 0.9 of its height.
UPRIGHT_ANGLE = 0.451
# Compensation during swing-up, unless the user chooses another one.
COMPENSATION = "coulomb"
# Process noise of the estimator: ten times the default, because the model errs more in large motion
# than near upright, and because the loop then tolerates more delay [V/√s, rad/s/√s].
PROCESS_NOISE = {"friction_process_noise": 3.0, "pendulum_process_noise": 1.0}
# A pendulum that hangs, as an initial state within the range of θ.
HANGING = -pi


class SwingUpRun(NamedTuple):
    """When the pendulum was upright for good [s], NaN if never; and whether a limit was exceeded.

    ``arm_angle_rad`` and ``arm_speed_rad_s`` are the largest of the run.
    """

    upright_s: float
    beyond_limits: bool
    arm_angle_rad: float
    arm_speed_rad_s: float


def swing_up_settings(rig: Rig) -> Settings:
    """Parameters of every node for swing-up on a rig, from hanging at rest."""
    settings = rig_settings(rig)
    settings["controller"] |= {"mode": "swing_up"}
    settings["estimator"] |= {"method": "whole_circle", **PROCESS_NOISE}
    settings["friction_observer"] |= {"compensation": COMPENSATION}
    settings["plant"] |= {"initial.theta": HANGING}
    return settings


def judge(run: Record, loop: Loop) -> SwingUpRun:
    """What a run shows. The limits are those of the controller."""
    arm, speed = (float(np.max(np.abs(run.state[:, i]))) for i in (PHI, PHI_DOT))
    p = loop.controller
    beyond = (
        arm > p.arm_angle_limit
        or speed > p.arm_speed_limit
        or float(np.max(np.abs(run.command))) > p.voltage_limit
    )
    return SwingUpRun(upright_since(run.state, run.sample_time), beyond, arm, speed)


def upright_since(state: np.ndarray, sample_time: float) -> float:
    """Time [s] from which the pendulum stays upright; NaN if it is not upright at the end."""
    down = np.nonzero(np.cos(state[:, THETA]) < cos(UPRIGHT_ANGLE))[0]
    since = int(down[-1]) + 1 if len(down) else 0
    return since * sample_time if since < len(state) else float("nan")


def with_initial(loop: Loop, state: Any, seed: int) -> Loop:
    """The loop from another initial ``state`` (φ, φ̇, θ, θ̇) and with another seed."""
    initial = type(loop.plant.initial)(*map(float, state))
    return loop._replace(plant=loop.plant._replace(initial=initial, seed=seed))
