"""The whole loop without ROS, compiled: the very functions that the nodes call, in their order.

One sample: sensors → estimator → friction observer → controller → actuator and plant.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_control.controller import MEMORY as CONTROLLER_MEMORY
from furuta_control.controller import StateFeedback, control, state_feedback
from furuta_control.estimator import MEMORY as ESTIMATOR_MEMORY
from furuta_control.estimator import Estimator, estimate_state, estimator
from furuta_control.parameters import ControllerParameters, EstimatorParameters
from furuta_friction.compensators import MEMORY as OBSERVER_MEMORY
from furuta_friction.compensators import Compensator, compensator, estimate_friction
from furuta_friction.parameters import ObserverParameters
from furuta_model.compiled import compiled
from furuta_model.lugre import friction
from furuta_model.state import BRISTLE, EFFORT, PHI_DOT, RIGID_STATES, SIGNALS
from furuta_sim.parameters import Plant
from furuta_sim.rig import NOISE_CHANNELS, initial_state, measure, move, substeps


class Loop(NamedTuple):
    """Parameters of every member of the loop."""

    plant: Plant = Plant()
    estimator: EstimatorParameters = EstimatorParameters()
    observer: ObserverParameters = ObserverParameters()
    controller: ControllerParameters = ControllerParameters()


class Record(NamedTuple):
    """Series of a run, one row per sample of ``sample_time`` [s].

    ``state`` (n, 4) true x, ``estimate`` (n, 5) of x and of the friction [V], ``friction`` (n,)
    true F [V], ``friction_estimate`` (n,) F̂ [V], ``command`` (n,) u [V].
    """

    sample_time: float
    state: np.ndarray
    estimate: np.ndarray
    friction: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray

    @property
    def time(self) -> np.ndarray:
        """Time of each sample (n,) [s]."""
        return np.arange(len(self.command)) * self.sample_time


class Memory(NamedTuple):
    """What the members of the loop keep from sample to sample, and the torque applied (1,) [V]."""

    estimator: np.ndarray
    observer: np.ndarray
    controller: np.ndarray
    torque: np.ndarray


def fresh_memory() -> Memory:
    """The memory of a loop that has not begun."""
    sizes = (ESTIMATOR_MEMORY, OBSERVER_MEMORY, CONTROLLER_MEMORY, 1)
    return Memory(*(np.zeros(size) for size in sizes))


class Simulation:
    """A loop in motion; its parameters can be changed between two runs, as on the graph.

    What is only read at the start (initial state, seed, sample time) stays as it was.
    """

    def __init__(self, loop: Loop) -> None:
        self.loop = loop
        self._state = initial_state(loop.plant)
        self._noise = np.random.default_rng(loop.plant.seed)
        self._memory = fresh_memory()

    @property
    def loop(self) -> Loop:
        """The parameters in force."""
        return self._loop

    @loop.setter
    def loop(self, loop: Loop) -> None:
        self._loop = loop
        self._members = (
            substeps(loop.plant),
            loop.plant,
            estimator(loop.estimator),
            compensator(loop.observer),
            state_feedback(loop.controller),
        )

    def run(self, seconds: float) -> Record:
        """Go on for ``seconds``, at least one sample."""
        record = _empty_record(self.loop.plant.sample_time, seconds)
        noise = self._noise.standard_normal((len(record.command), NOISE_CHANNELS))
        _run(self._state, noise, *self._members, self._memory, record)
        return record


def simulate(loop: Loop, seconds: float) -> Record:
    """Run the loop for ``seconds`` from the plant's initial state."""
    return Simulation(loop).run(seconds)


def _empty_record(sample_time: float, seconds: float) -> Record:
    samples = max(1, round(seconds / sample_time))
    return Record(
        sample_time,
        np.empty((samples, RIGID_STATES)),
        np.empty((samples, SIGNALS)),
        np.empty(samples),
        np.empty(samples),
        np.empty(samples),
    )


@compiled
def _run(
    x: np.ndarray,
    noise: np.ndarray,
    steps: int,
    plant: Plant,
    estimation: Estimator,
    observer: Compensator,
    feedback: StateFeedback,
    memory: Memory,
    record: Record,
) -> None:
    measurement = np.empty(SIGNALS)
    torque = memory.torque[0]
    for k in range(len(record.command)):
        record.state[k] = x[:RIGID_STATES]
        record.friction[k] = friction(x[PHI_DOT], x[BRISTLE], plant.friction)
        measure(x, noise[k], plant.sensors, measurement)
        measurement[EFFORT] = torque
        estimate = record.estimate[k]
        estimate_state(memory.estimator, measurement, estimation, estimate)
        estimated = estimate_friction(memory.observer, estimate, observer)
        u = control(memory.controller, estimate, estimated, feedback)
        record.friction_estimate[k] = estimated
        record.command[k] = u
        torque = move(x, u, steps, plant)
    memory.torque[0] = torque
