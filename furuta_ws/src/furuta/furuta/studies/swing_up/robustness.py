"""Robustness of swing-up: the criteria of the double-pendulum competition on a rig.

The definitions are those of ``leaderboard/acrobot/robustness_v2`` and ``analysis/benchmark.py`` in
dfki-ric-underactuated-lab/double_pendulum (:mod:`furuta.studies.swing_up.performance` cites it). In
every run one thing differs from the controller's model, in 21 levels. A run starts hanging at rest
and succeeds if every angle is within 0.35 rad and every speed within 1 rad/s of upright at 10 s.
Where noise is drawn, a level counts if more than half of its repetitions succeed. A criterion's
score is the fraction of levels that count, and the score of all is the mean of the six.

Times, speeds and ratios are taken over. Torques are converted by the torque limit, those on the
passive joint by its inertia and frequency (:func:`_torques`).
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from furuta.studies.swing_up.disturbed_drive import (
    DRIVE_PERIOD,
    DisturbedDrive,
    DisturbedRun,
    run_disturbed,
)
from furuta.studies.swing_up.performance import TORQUE_LIMIT
from furuta_model.parts.motion import PendulumFriction
from furuta_model.parts.pushes import Pushes
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_sim.lanes.batch import available_cores
from furuta_sim.simulation.closed_loop import Loop

CRITERIA = ("model", "speed_noise", "torque_noise", "torque_response", "delay", "pushes")

# Time of a run [s], and the largest deviations from upright at its end [rad, rad/s].
RUN_TIME = 10.0
ANGLE_ERROR, SPEED_ERROR = 0.35, 1.0
# Levels of a disturbance, and repetitions where noise is drawn.
LEVELS = 21
REPETITIONS = 10
# Largest relative error of inertias and gravity torque.
MODEL_ERROR = 0.25
# Largest errors of viscous friction [N m s/rad] and Coulomb friction [N m] of a joint.
VISCOUS_ERROR, COULOMB_ERROR = 0.1, 0.2
# Largest noise of the speeds [rad/s] and of the torque [N m], delay of the readings [s].
SPEED_NOISE, TORQUE_NOISE, DELAY = 0.5, 1.1, 0.04
# Slowest and fastest response of the torque.
RESPONSES = (0.1, 2.0)
# Random pushes: number of runs, pushes per joint, least time between two [s], standard deviation
# of their Gaussian shape [s] and height [N m].
PUSH_RUNS, PUSHES_PER_JOINT, PUSH_DISTANCE = 50, 3, 1.0
PUSH_WIDTH, PUSH_HEIGHT = (0.05, 0.1), (0.5, 5.0)
# The acrobot's inertia about its passive joint with straight links [kg m²], and its frequency.
INERTIA, FREQUENCY = 0.172, 4.72


class Case(NamedTuple):
    """A run of the benchmark, the criterion it belongs to, and its level within that."""

    criterion: str
    level: int
    loop: Loop
    disturbed: DisturbedDrive = DisturbedDrive()


class Robustness(NamedTuple):
    """Score of each criterion and of all, 0 to 1, and the number of runs."""

    model: float
    speed_noise: float
    torque_noise: float
    torque_response: float
    delay: float
    pushes: float
    score: float
    runs: int


def cases(loop: Loop, seed: int) -> list[Case]:
    """The runs of the benchmark for a loop."""
    drawn = np.random.default_rng(seed)
    found = [
        *_model(loop),
        *_noise(loop),
        *_drive(loop),
        *_delay(loop),
        *_random_pushes(loop, drawn),
    ]
    return [_with_seed(each, seed + k) for k, each in enumerate(found)]


def run_cases(chosen: list[Case]) -> list[bool]:
    """Whether each run succeeds. The runs share all cores."""
    with ThreadPoolExecutor(available_cores()) as pool:
        return list(pool.map(_succeeds, chosen))


def robustness(chosen: list[Case], successes: list[bool]) -> Robustness:
    """The scores of the runs."""
    scores = {name: _score(name, chosen, successes) for name in CRITERIA}
    return Robustness(**scores, score=sum(scores.values()) / len(scores), runs=len(chosen))


def upright_at_end(run: DisturbedRun, arm_reference: float) -> bool:
    """Whether a run ends upright."""
    end = run.state[-1].copy()
    end[PHI] -= arm_reference
    end[THETA] = (end[THETA] + pi) % (2.0 * pi) - pi
    angles, speeds = np.abs(end[[PHI, THETA]]), np.abs(end[[PHI_DOT, THETA_DOT]])
    return bool(np.all(angles < ANGLE_ERROR) and np.all(speeds < SPEED_ERROR))


def _succeeds(case: Case) -> bool:
    run = run_disturbed(case.loop, case.disturbed, RUN_TIME)
    return upright_at_end(run, case.loop.controller.arm_reference)


def _score(criterion: str, chosen: list[Case], successes: list[bool]) -> float:
    levels: dict[int, list[bool]] = {}
    for case, success in zip(chosen, successes, strict=True):
        if case.criterion == criterion:
            levels.setdefault(case.level, []).append(success)
    return float(np.mean([np.mean(each) > 0.5 for each in levels.values()]))


def _with_seed(case: Case, seed: int) -> Case:
    return case._replace(loop=case.loop._replace(plant=case.loop.plant._replace(seed=seed)))


def _model(loop: Loop) -> Iterator[Case]:
    """One parameter of the rig off the controller's model: inertias, gravity torque, friction.

    Friction below zero, which the competition has, is impossible: it starts at zero.
    """
    plant, volt = loop.plant, loop.controller.voltage_limit / TORQUE_LIMIT
    model, friction = plant.model, plant.friction.parameters
    relative = np.linspace(1.0 - MODEL_ERROR, 1.0 + MODEL_ERROR, LEVELS)
    changed = [
        plant._replace(model=model._replace(**{name: float(each) * getattr(model, name)}))
        for name in model._fields
        for each in relative
    ]
    viscous, level = VISCOUS_ERROR * volt, COULOMB_ERROR * volt
    for name, error in (("viscous", viscous), ("alpha0", level)):
        given = getattr(friction, name)
        for each in np.linspace(max(given - error, 0.0), given + error, LEVELS):
            parameters = friction._replace(**{name: float(each)})
            changed.append(plant._replace(friction=plant.friction._replace(parameters=parameters)))
    # On the passive joint relative to its own inertia, frequency and gravity torque.
    scale = model.beta / INERTIA
    frequency = sqrt(model.delta / model.beta) / FREQUENCY
    for each in np.linspace(0.0, 1.0, LEVELS):
        damping = VISCOUS_ERROR * scale * frequency * float(each)
        coulomb = COULOMB_ERROR * scale * frequency**2 * float(each)
        own = plant.pendulum_friction
        for joint in (
            PendulumFriction(own.damping + damping, own.coulomb),
            PendulumFriction(own.damping, own.coulomb + coulomb),
        ):
            changed.append(plant._replace(pendulum_friction=joint))
    for number, each_plant in enumerate(changed):
        yield Case("model", number, loop._replace(plant=each_plant))


def _noise(loop: Loop) -> Iterator[Case]:
    """Noise of the speeds, and of the torque.

    The pendulum's speed is not measured. Its angle gets the noise whose difference over a sample of
    the competition has that standard deviation.
    """
    sensors, volt = loop.plant.sensors, loop.controller.voltage_limit / TORQUE_LIMIT
    for level, part in enumerate(np.linspace(0.0, 1.0, LEVELS)):
        speed = SPEED_NOISE * float(part)
        angle = speed * DRIVE_PERIOD / sqrt(2.0)
        noisy = sensors._replace(
            tachometer_noise=sqrt(sensors.tachometer_noise**2 + speed**2),
            potentiometer_noise=sqrt(sensors.potentiometer_noise**2 + angle**2),
        )
        with_noise = loop._replace(plant=loop.plant._replace(sensors=noisy))
        drive = DisturbedDrive(noise=TORQUE_NOISE * volt * float(part))
        for _ in range(REPETITIONS):
            yield Case("speed_noise", level, with_noise)
            yield Case("torque_noise", level, loop, drive)


def _drive(loop: Loop) -> Iterator[Case]:
    """A torque that follows the command slowly, or overshoots it."""
    for level, response in enumerate(np.linspace(*RESPONSES, LEVELS)):
        yield Case("torque_response", level, loop, DisturbedDrive(response=float(response)))


def _delay(loop: Loop) -> Iterator[Case]:
    """Readings that are late."""
    plant = loop.plant
    for level, delay in enumerate(np.linspace(0.0, DELAY, LEVELS)):
        samples = round(float(delay) / plant.sample_time)
        faults = plant.sensor_faults._replace(reading_delay=samples)
        yield Case("delay", level, loop._replace(plant=plant._replace(sensor_faults=faults)))


def _random_pushes(loop: Loop, drawn: np.random.Generator) -> Iterator[Case]:
    """Pushes on both joints at random times."""
    for level in range(PUSH_RUNS):
        pushes = _pushes(loop, drawn)
        yield Case("pushes", level, loop._replace(plant=loop.plant._replace(pushes=pushes)))


def _pushes(loop: Loop, drawn: np.random.Generator) -> Pushes:
    """Pushes of a run: rectangles with height and impulse of the competition's Gaussian shapes."""
    number = 2 * PUSHES_PER_JOINT
    room = (RUN_TIME - (number + 1) * PUSH_DISTANCE) / number
    middles = np.cumsum(PUSH_DISTANCE + room * drawn.random(number))
    durations = sqrt(2.0 * pi) * drawn.uniform(*PUSH_WIDTH, number)
    heights = drawn.uniform(-1.0, 1.0, number) * (PUSH_HEIGHT[1] - PUSH_HEIGHT[0])
    heights += PUSH_HEIGHT[0] * np.sign(heights)
    on_arm = np.zeros(number, dtype=bool)
    on_arm[drawn.permutation(number)[:PUSHES_PER_JOINT]] = True
    arm, pendulum = _torques(loop, heights)
    return Pushes(
        times=_numbers(middles - 0.5 * durations),
        durations=_numbers(durations),
        arm=_numbers(np.where(on_arm, arm, 0.0)),
        pendulum=_numbers(np.where(on_arm, 0.0, pendulum)),
    )


def _torques(loop: Loop, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Torques [V] on arm and pendulum for ``heights`` [N m] of the competition.

    On the arm it is the same share of the torque limit. On the pendulum it changes the speed,
    relative to the frequency of the joint, as on the acrobot's passive joint.
    """
    p = loop.controller
    frequency = sqrt(p.model.delta / p.model.beta)
    on_arm = heights * p.voltage_limit / TORQUE_LIMIT
    return on_arm, heights * p.model.beta * frequency / (INERTIA * FREQUENCY)


def _numbers(array: np.ndarray) -> tuple[float, ...]:
    return tuple(float(each) for each in array)
