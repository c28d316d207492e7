"""Swing-up on a rig: from random states, on plants that differ from its model, and after pushes."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from math import cos, pi, sqrt
from typing import NamedTuple

import numpy as np

from furuta.lanes.batch import available_cores
from furuta.settings.settings import Settings, rig_settings
from furuta_control.control import design_controller
from furuta_control.modes.swing_up import SwingUpParameters
from furuta_hw.rigs.rig import Rig
from furuta_model.parts.disturbances import Pushes
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_sim.parameters import InitialState
from furuta_sim.simulation.closed_loop import Loop, Record, simulate

# Pendulum angle [rad] within which it counts as upright: its tip is above 0.9 of its height.
UPRIGHT_ANGLE = 0.451
# Starts whose motion is shown, and interval [s] of their angles.
SHOWN, SHOWN_INTERVAL = 50, 0.02
# Compensation during swing-up, unless the user chooses another one.
COMPENSATION = "coulomb"
# Process noise of the estimator: ten times the default, because the model errs more in large motion
# than near upright, and because the loop then tolerates more delay [V/√s, rad/s/√s].
PROCESS_NOISE = {"friction_process_noise": 3.0, "pendulum_process_noise": 1.0}
# A pendulum that hangs, as an initial state within the range of θ.
HANGING = -pi


class SwingUpRun(NamedTuple):
    """When the pendulum was upright for good [s], NaN if never; whether a limit was exceeded.

    ``arm`` and ``speed`` are the largest of the arm relative to its limits, and ``theta`` (n,)
    [rad] is the pendulum's angle over the whole run.
    """

    upright_s: float
    beyond_limits: bool
    arm: float
    speed: float
    theta: np.ndarray


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
    p = loop.controller
    angle = float(np.max(np.abs(run.state[:, PHI]))) / p.balance.arm_angle_limit
    speed = float(np.max(np.abs(run.state[:, PHI_DOT]))) / p.balance.arm_speed_limit
    beyond = max(angle, speed) > 1.0 or float(np.max(np.abs(run.command))) > p.voltage_limit
    shown = slice(None, None, max(1, round(SHOWN_INTERVAL / run.sample_time)))
    since = upright_since(run.state, run.sample_time)
    return SwingUpRun(since, beyond, angle, speed, run.state[shown, THETA].copy())


def upright_since(state: np.ndarray, sample_time: float) -> float:
    """Time [s] from which the pendulum stays upright; NaN if it is not upright at the end."""
    down = np.nonzero(np.cos(state[:, THETA]) < cos(UPRIGHT_ANGLE))[0]
    since = int(down[-1]) + 1 if len(down) else 0
    return since * sample_time if since < len(state) else float("nan")


# Time of a run [s], and time by which the pendulum must be upright.
RUN_TIME = 12.0
DEADLINE = 10.0
# Largest deviation of inertias, gravity torque and friction levels from the model, relative.
DEVIATION = 0.1
# Part of the arm's speed limit up to which starts have speed.
START_SPEED = 0.95
# Part of the voltage for the pendulum's centrifugal torque on the arm.
HOLDING_VOLTAGE = 0.7


@dataclass(frozen=True)
class StartResults:
    """Number of starts, upright by the deadline, beyond a limit; times upright [s]."""

    starts: int
    upright: int
    beyond_limits: int
    median_s: float
    worst_s: float


def random_starts(loop: Loop, starts: int, seed: int) -> list[Loop]:
    """Loops whose plants and initial states are drawn at random. The controller stays the same."""
    generator = np.random.default_rng(seed)
    return [_random_start(loop, generator, seed + k) for k in range(starts)]


def run_starts(loops: list[Loop]) -> Iterator[SwingUpRun]:
    """Run the loops on all cores; the results in order. Only the first ones have an angle."""
    with ThreadPoolExecutor(available_cores()) as pool:
        for number, run in enumerate(pool.map(_run, loops)):
            yield run if number < SHOWN else run._replace(theta=np.empty(0))


def starts_summary(runs: Sequence[SwingUpRun]) -> StartResults:
    """The results of all runs."""
    times = np.array([run.upright_s for run in runs])
    in_time = times <= DEADLINE
    known = times[in_time]
    return StartResults(
        len(runs),
        int(np.sum(in_time)),
        sum(run.beyond_limits for run in runs),
        float(np.median(known)) if len(known) else float("nan"),
        float(np.max(known)) if len(known) else float("nan"),
    )


def _run(loop: Loop) -> SwingUpRun:
    return judge(simulate(loop, RUN_TIME), loop)


def _random_start(loop: Loop, generator: np.random.Generator, seed: int) -> Loop:
    factors = 1.0 + DEVIATION * generator.uniform(-1.0, 1.0, 6)
    plant = loop.plant
    model = FurutaPendulum(
        *(value * factor for value, factor in zip(plant.model, factors[:4], strict=True))
    )
    p, (levels, viscous) = plant.friction.parameters, factors[4:]
    p = p._replace(alpha0=p.alpha0 * levels, alpha1=p.alpha1 * levels, viscous=p.viscous * viscous)
    friction = plant.friction._replace(parameters=p)
    initial = InitialState(*_random_state(loop, generator))
    changed = plant._replace(model=model, friction=friction, initial=initial, seed=seed)
    return loop._replace(plant=changed)


def _random_state(loop: Loop, generator: np.random.Generator) -> tuple[float, float, float, float]:
    """Any pendulum angle, and speeds up to what the limits allow.

    The arm can be stopped within the used travel by half of the planned braking. The pendulum is at
    most as fast as after a fall from upright, and passes the horizontal so slowly that a part of
    the voltage, :data:`HOLDING_VOLTAGE`, holds the arm against its centrifugal torque γθ̇².
    """
    p = loop.controller
    limits = design_controller(p).swing_up.limits
    squared = p.model.delta / p.model.beta
    travel = min(limits.travel, 2.0 * pi)
    while True:
        phi = generator.uniform(-travel, travel)
        speed = START_SPEED * p.balance.arm_speed_limit * generator.uniform(-1.0, 1.0)
        theta = generator.uniform(-pi, pi)
        pendulum_speed = 2.0 * sqrt(squared) * generator.uniform(-1.0, 1.0)
        at_horizontal = p.model.gamma * (pendulum_speed**2 + 2.0 * squared * cos(theta))
        stops = abs(phi + speed * abs(speed) / limits.braking) < limits.travel
        if stops and at_horizontal < HOLDING_VOLTAGE * p.voltage_limit:
            return phi, speed, theta, pendulum_speed


# Time of the run, and time between two pushes [s].
KNOCKS_TIME, PERIOD = 60.0, 10.0
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
    again = loop.controller._replace(swing_up=SwingUpParameters(recover=True))
    model = loop.plant.model
    number = round(KNOCKS_TIME / PERIOD) - 1
    pushes = Pushes(
        times=tuple(PERIOD * (k + 1) for k in range(number)),
        durations=(DURATION * sqrt(model.beta / model.delta),),
        pendulum=tuple((-1.0) ** (k + 1) * TORQUE * model.delta for k in range(number)),
    )
    pushed = loop._replace(plant=loop.plant._replace(pushes=pushes), controller=again)
    return count_knocks(simulate(pushed, KNOCKS_TIME))


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
