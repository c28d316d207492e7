"""The loop with a drive that does not do what the controller commands, and with knock-downs.

The drive takes a new torque every :data:`DRIVE_PERIOD`. It moves from the last torque τ to the
command u by a part of the difference, the response k, and adds white noise w:

.. math::
    τ_{n+1} = (1 - k) τ_n + k u + w

limited to the drive's range. The control system knows nothing of it: the measurement contains the
commanded voltage.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.parts.converter import drive
from furuta_model.parts.pushes import PENDULUM, Pushes
from furuta_model.state import APPLIED_TORQUE, RIGID_STATES, SIGNALS, THETA
from furuta_sim.plant import NOISE_CHANNELS, Plant, design_plant, initial_state, move, read
from furuta_sim.simulation.closed_loop import Loop
from furuta_sim.simulation.control_system import (
    ControlSystem,
    Memory,
    control_sample,
    design_control_system,
    initial_memory,
)

# Time between two torques of the drive [s], the sample time of the competition.
DRIVE_PERIOD = 0.002
# Torque of a knock-down, in units of the pendulum's gravity torque δ.
KNOCK_DOWN_TORQUE = 2.0
# The push that knocks the pendulum down, as long as a profile allows; the loop sets its torque.
_PREPARED_PUSH = Pushes(durations=(1e6,), pendulum=(1.0,))


class DisturbedDrive(NamedTuple):
    """Response k, and standard deviation of the torque's noise [V].

    Every ``knock_down_period`` [s] the pendulum is pushed until it is below the horizontal, unless
    that is 0.
    """

    response: float = 1.0
    noise: float = 0.0
    knock_down_period: float = 0.0


class DisturbedRun(NamedTuple):
    """True states (n, 4) and commands (n,) [V] of a run, one row per ``sample_time`` [s]."""

    sample_time: float
    state: np.ndarray
    command: np.ndarray


def run_disturbed(loop: Loop, disturbed: DisturbedDrive, seconds: float) -> DisturbedRun:
    """Run the loop for ``seconds`` from its initial state with a disturbed drive.

    Knock-downs replace the loop's own pushes.
    """
    p = loop.plant
    if disturbed.knock_down_period > 0.0:
        p = p._replace(pushes=_PREPARED_PUSH)
    plant, samples = design_plant(p), round(seconds / p.sample_time)
    run = DisturbedRun(p.sample_time, np.empty((samples, RIGID_STATES)), np.empty(samples))
    _run(
        initial_state(p),
        np.random.default_rng(p.seed),
        plant,
        design_control_system(loop.estimator, loop.observer, loop.controller),
        initial_memory(),
        disturbed,
        max(1, round(DRIVE_PERIOD / p.sample_time)),
        round(disturbed.knock_down_period / p.sample_time),
        run,
    )
    return run


@compiled
def _run(
    x: np.ndarray,
    generator: np.random.Generator,
    plant: Plant,
    control_system: ControlSystem,
    memory: Memory,
    disturbed: DisturbedDrive,
    drive_samples: int,
    knock_down_samples: int,
    run: DisturbedRun,
) -> None:
    """Fill ``run``; a drive takes a new torque every ``drive_samples`` samples."""
    measurement, estimate = np.empty(SIGNALS), np.empty(SIGNALS)
    noise = np.zeros(NOISE_CHANNELS)
    estimator_memory, observer_memory = memory.estimator, memory.observer
    controller_memory = memory.controller
    torque, commanded = 0.0, 0.0
    knocked = False
    for k in range(len(run.command)):
        for channel in range(NOISE_CHANNELS):
            noise[channel] = generator.standard_normal()
        read(x, noise, plant, measurement)
        measurement[APPLIED_TORQUE] = commanded
        _, u = control_sample(
            estimator_memory,
            observer_memory,
            controller_memory,
            measurement,
            control_system,
            estimate,
        )
        run.state[k] = x[:RIGID_STATES]
        run.command[k] = u
        if k % drive_samples == 0:
            torque = (1.0 - disturbed.response) * torque + disturbed.response * u
            if disturbed.noise > 0.0:
                torque += disturbed.noise * generator.standard_normal()
            torque = min(max(torque, -plant.actuator.voltage_range), plant.actuator.voltage_range)
        if knock_down_samples > 0:
            knocked = _knock_down(x, k, knock_down_samples, knocked, plant)
        commanded = drive(u, plant.actuator)
        move(x, torque, plant)


@compiled
def _knock_down(x: np.ndarray, k: int, period: int, knocked: bool, plant: Plant) -> bool:
    """Push the pendulum until it is below the horizontal; whether it is still being pushed."""
    knocked = knocked or (k > 0 and k % period == 0)
    knocked = knocked and np.cos(x[THETA]) > 0.0
    side = 1.0 if (k // period) % 2 == 0 else -1.0
    push = side * KNOCK_DOWN_TORQUE * plant.model.delta
    plant.parts.pushes[0, PENDULUM] = push if knocked else 0.0
    return knocked
