"""Time upright of a swing-up whose pendulum is pushed over again and again."""

from math import cos, sqrt
from typing import NamedTuple

import numpy as np

from furuta.studies.swing_up_starts import UPRIGHT_ANGLE
from furuta_model.parts.disturbances import Pushes
from furuta_model.state import THETA
from furuta_sim.simulation.closed_loop import Loop, Record, simulate

# Time of the run, and time between two pushes [s].
RUN_TIME, PERIOD = 60.0, 10.0
# Torque of a push in units of the gravity torque δ, and its duration in units of √(β/δ). An arm
# that stands still would let the pendulum reach the horizontal in 1.17 of them.
TORQUE, DURATION = 2.0, 1.5


class Knocks(NamedTuple):
    """Number of pushes, falls, and swing-ups until the next push; time upright of 60 s [s]."""

    pushes: int
    falls: int
    swing_ups: int
    upright_s: float


def run_knocks(loop: Loop) -> Knocks:
    """Swing up from the initial state, and again after every push."""
    parts = loop.controller.parts
    parts = parts._replace(swing_up=parts.swing_up._replace(recover=True))
    model = loop.plant.model
    number = round(RUN_TIME / PERIOD) - 1
    pushes = Pushes(
        times=tuple(PERIOD * (k + 1) for k in range(number)),
        durations=(DURATION * sqrt(model.beta / model.delta),),
        pendulum=tuple((-1.0) ** (k + 1) * TORQUE * model.delta for k in range(number)),
    )
    pushed = loop._replace(
        plant=loop.plant._replace(pushes=pushes),
        controller=loop.controller._replace(parts=parts),
    )
    return count_knocks(simulate(pushed, RUN_TIME))


def count_knocks(run: Record) -> Knocks:
    """What a run shows; a fall leaves the angle within which the pendulum counts as upright."""
    upright = np.cos(run.state[:, THETA]) > cos(UPRIGHT_ANGLE)
    period = round(PERIOD / run.sample_time)
    after_push = [upright[k : k + period] for k in range(period, len(upright), period)]
    fallen = [part for part in after_push if not np.all(part)]
    return Knocks(
        pushes=len(after_push),
        falls=len(fallen),
        swing_ups=sum(bool(part[-1]) for part in fallen),
        upright_s=float(np.sum(upright)) * run.sample_time,
    )
