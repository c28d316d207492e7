"""The whole loop without ROS, compiled: the very functions that the nodes call, in their order.

One sample: sensors → estimator → friction observer → controller → actuator and plant.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_control.controller import MEMORY as CONTROLLER_MEMORY
from furuta_control.controller import StateFeedback, control, state_feedback
from furuta_control.estimator import MEMORY as ESTIMATOR_MEMORY
from furuta_control.estimator import LowPass, estimate_state, sample_filter
from furuta_control.parameters import ControllerParameters, EstimatorParameters
from furuta_friction.compensators import MEMORY as OBSERVER_MEMORY
from furuta_friction.compensators import Compensator, compensator, estimate_friction
from furuta_friction.parameters import ObserverParameters
from furuta_model.compiled import compiled
from furuta_model.lugre import friction
from furuta_model.state import BRISTLE, PHI_DOT, RIGID_STATES
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

    ``state`` (n, 4) true x, ``estimate`` (n, 4) of x, ``friction`` (n,) true F [V],
    ``friction_estimate`` (n,) F̂ [V], ``command`` (n,) u [V].
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


def simulate(loop: Loop, seconds: float) -> Record:
    """Run the loop for ``seconds`` from the plant's initial state."""
    plant = loop.plant
    samples = max(1, round(seconds / plant.sample_time))
    record = Record(
        plant.sample_time,
        np.empty((samples, RIGID_STATES)),
        np.empty((samples, RIGID_STATES)),
        np.empty(samples),
        np.empty(samples),
        np.empty(samples),
    )
    noise = np.random.default_rng(plant.seed).standard_normal((samples, NOISE_CHANNELS))
    _run(
        initial_state(plant),
        noise,
        substeps(plant),
        plant,
        sample_filter(loop.estimator),
        compensator(loop.observer),
        state_feedback(loop.controller),
        record,
    )
    return record


@compiled
def _run(
    x: np.ndarray,
    noise: np.ndarray,
    steps: int,
    plant: Plant,
    filter_: LowPass,
    observer: Compensator,
    feedback: StateFeedback,
    record: Record,
) -> None:
    filter_memory = np.zeros(ESTIMATOR_MEMORY)
    observer_memory = np.zeros(OBSERVER_MEMORY)
    controller_memory = np.zeros(CONTROLLER_MEMORY)
    measurement = np.empty(RIGID_STATES)
    for k in range(len(record.command)):
        record.state[k] = x[:RIGID_STATES]
        record.friction[k] = friction(x[PHI_DOT], x[BRISTLE], plant.friction)
        measure(x, noise[k], plant.sensors, measurement)
        estimate = record.estimate[k]
        estimate_state(filter_memory, measurement, filter_, estimate)
        estimated = estimate_friction(observer_memory, estimate, observer)
        u = control(controller_memory, estimate, estimated, feedback)
        record.friction_estimate[k] = estimated
        record.command[k] = u
        move(x, u, steps, plant)
