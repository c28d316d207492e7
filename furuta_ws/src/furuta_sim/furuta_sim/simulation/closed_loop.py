"""Simulates the closed loop without ROS, with the compiled functions that the nodes call.

One sample: sensors → estimator → friction observer → controller → actuator and plant. A run is
a few calls of compiled code, which releases the interpreter lock.
"""

from dataclasses import dataclass, field
from typing import Annotated, Any, NamedTuple

import numpy as np

from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.block import new_memory
from furuta_model.compiled import compiled, inlined
from furuta_model.parameters import ParameterError, declared, values
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.progress import Progress, unseen
from furuta_model.state import APPLIED_TORQUE, RIGID_STATES, SIGNALS
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant import (
    NOISE_CHANNELS,
    Plant,
    changed_plant,
    initial_plant,
    move,
    read,
    true_friction,
)
from furuta_sim.simulation.control_system import (
    ControlMemory,
    ControlSystem,
    control_sample,
    design_control_system,
)


@dataclass
class LoopMemory:
    """What a loop remembers; ``torque`` [V] is that applied since the last measurement."""

    plant: PlantMemory = field(default_factory=PlantMemory)
    control: ControlMemory = field(default_factory=ControlMemory)
    torque: float = 0.0


# The nodes that have the parameters of a loop, in the loop's order.
PARTS = "plant", "estimator", "friction_observer", "controller"
# Simulated time of a call of compiled code [s]: Python handles Ctrl-C between two calls.
BLOCK_SECONDS = 20.0
# Most values that a loop prints.
MOST_PRINTED = 6


class Loop(NamedTuple):
    """Parameters of plant, estimator, friction observer and controller."""

    plant: PlantParameters = PlantParameters()
    estimator: EstimatorParameters = EstimatorParameters()
    observer: ObserverParameters = ObserverParameters()
    controller: ControllerParameters = ControllerParameters()

    def __repr__(self) -> str:
        """What differs from the loop of the paper, by the names of the nodes' parameters."""
        usual = _named(Loop())
        changed = [
            f"{name}={value:.6g}" if isinstance(value, float) else f"{name}={value!r}"
            for name, value in _named(self).items()
            if value != usual.get(name)
        ]
        more = f"and {len(changed) - MOST_PRINTED} more"
        shown = changed[:MOST_PRINTED] + [more] * (len(changed) > MOST_PRINTED)
        return f"Loop({', '.join(shown)})"


def _named(loop: Loop) -> dict[str, Any]:
    """The values of a loop by the names of the nodes' parameters."""
    parts = zip(PARTS, loop, strict=True)
    return {f"{part}.{name}": each for part, group in parts for name, each in values(group).items()}


def _check_constant(before: Loop, loop: Loop) -> None:
    """Reject other values of parameters that are only read at the start."""
    if before == loop:
        return
    former, given = _named(before), _named(loop)
    for part, group in zip(PARTS, loop, strict=True):
        for each in declared(type(group)):
            name = f"{part}.{each.name}"
            if each.about.read_only and given[name] != former[name]:
                raise ParameterError(
                    f"{name} is {former[name]:g} for the whole simulation, given "
                    f"{given[name]:g}; make another Simulation"
                )


class Record(NamedTuple):
    """Series of a run, one row per sample of ``sample_time`` [s].

    ``state`` (n, 4) true x, ``estimate`` (n, 5) of x, then the torque as measured [V],
    ``friction`` (n,) true F [V], ``friction_estimate`` (n,) F̂ [V], ``command`` (n,) u [V],
    ``measurement`` (n, 5) of x, NaN where there is no sensor, and of the torque applied since the
    previous sample [V].
    """

    sample_time: float
    state: Annotated[np.ndarray, "n", RIGID_STATES]
    estimate: Annotated[np.ndarray, "n", SIGNALS]
    friction: Annotated[np.ndarray, "n"]
    friction_estimate: Annotated[np.ndarray, "n"]
    command: Annotated[np.ndarray, "n"]
    measurement: Annotated[np.ndarray, "n", SIGNALS]

    @property
    def time(self) -> np.ndarray:
        """Time of each sample (n,) [s]."""
        return np.arange(len(self.command)) * self.sample_time


class Simulation:
    """Simulates a loop. Its parameters can be changed between two runs, as on the graph.

    Those that are only read at the start (initial state, seed, sample times) cannot.

    Attributes:
        memory: The :class:`LoopMemory`, as a block.
        noise: Generator of the sensors' noise.
        plant: The design of the plant; ``control_system``: that of the other three.
    """

    def __init__(self, loop: Loop) -> None:
        self.memory = new_memory(LoopMemory)
        self.memory["plant"] = initial_plant(loop.plant)
        self.noise = np.random.default_rng(loop.plant.seed)
        self._loop = loop
        self.loop = loop

    @property
    def state(self) -> np.ndarray:
        """Plant state (5,); it can be changed between two runs."""
        state: np.ndarray = self.memory["plant"]["x"][0]
        return state

    @property
    def loop(self) -> Loop:
        """The current parameters."""
        return self._loop

    @loop.setter
    def loop(self, loop: Loop) -> None:
        _check_constant(self._loop, loop)
        self.plant = changed_plant(self.memory["plant"], self._loop.plant, loop.plant)
        self._loop = loop
        self.control_system = design_control_system(loop.estimator, loop.observer, loop.controller)

    def samples(self, seconds: float) -> int:
        """Number of samples in ``seconds``, at least one."""
        return max(1, round(seconds / self.loop.plant.sample_time))

    def run(self, seconds: float, progress: Progress = unseen) -> Record:
        """Continue for ``seconds``, at least one sample, and keep the series."""
        dt, samples = self.loop.plant.sample_time, self.samples(seconds)
        record, size = _empty_record(dt, samples), self.samples(BLOCK_SECONDS)
        blocks = range(0, samples, size)
        for first in progress(blocks, len(blocks)):
            block = Record(dt, *(series[first : first + size] for series in record[1:]))
            _run(self.memory, self.noise, self.plant, self.control_system, block)
        return record


def simulate(loop: Loop, seconds: float, progress: Progress = unseen) -> Record:
    """Run the loop for ``seconds`` from the plant's initial state and keep its series."""
    return Simulation(loop).run(seconds, progress)


def _empty_record(sample_time: float, samples: int) -> Record:
    """A record for ``samples`` samples, not yet filled."""
    return Record(
        sample_time,
        np.empty((samples, RIGID_STATES)),
        np.empty((samples, SIGNALS)),
        np.empty(samples),
        np.empty(samples),
        np.empty(samples),
        np.empty((samples, SIGNALS)),
    )


@inlined
def control_measured(
    loop: LoopMemory,
    noise: np.ndarray,
    plant: Plant,
    control_system: ControlSystem,
    measurement: np.ndarray,
    estimate: np.ndarray,
) -> tuple[float, float]:
    """Measure and control: F̂ and u [V] of a sample. It ends when the plant is moved by u."""
    read(loop.plant, noise, plant, measurement)
    measurement[APPLIED_TORQUE] = loop.torque
    return control_sample(loop.control, measurement, control_system, estimate)


@compiled
def _run(
    memory: np.ndarray,
    generator: np.random.Generator,
    plant: Plant,
    control_system: ControlSystem,
    record: Record,
) -> None:
    """Run the loop for as many samples as the record has rows."""
    measurement, estimate = np.empty(SIGNALS), np.empty(SIGNALS)
    noise = np.zeros(NOISE_CHANNELS)
    loop = memory[0]
    for k in range(len(record.command)):
        if not plant.sensors.ideal:
            for channel in range(NOISE_CHANNELS):
                noise[channel] = generator.standard_normal()
        friction_estimate, u = control_measured(
            loop, noise, plant, control_system, measurement, estimate
        )
        # By elements: numba compiles an assignment of rows for seconds.
        for i in range(RIGID_STATES):
            record.state[k, i] = loop.plant.x[i]
        for i in range(SIGNALS):
            record.estimate[k, i] = estimate[i]
            record.measurement[k, i] = measurement[i]
        record.friction[k] = true_friction(loop.plant, plant)
        record.friction_estimate[k] = friction_estimate
        record.command[k] = u
        loop.torque = move(loop.plant, u, plant)
