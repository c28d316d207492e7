"""Simulates the closed loop without ROS, with the compiled functions that the nodes call.

One sample: sensors → estimator → friction observer → controller → actuator and plant. A run is
one call of compiled code, which releases the interpreter lock. Oscillation and rms values are
measured during the run; series are kept only on request.
"""

from dataclasses import dataclass, field
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.block import new_memory
from furuta_model.compiled import compiled, inlined
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.state import APPLIED_TORQUE, PHI, RIGID_STATES, SIGNALS, THETA
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant import (
    NOISE_CHANNELS,
    Plant,
    design_plant,
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
from furuta_sim.simulation.oscillation import (
    OscillationSums,
    accumulate,
    accumulate_midpoint,
    oscillation,
)

# Fraction of a run that is measured: the last half, after the transients.
SETTLED = 0.5
# Rate [1/s] of the filter that separates the fast part of the command: 50 Hz.
FAST = 100.0 * np.pi


@dataclass
class Sums:
    """What is accumulated in a run: the oscillation, and sums over the measured part.

    ``phi``, ``command`` and ``error`` are those of the squares of φ [rad²], u and F − F̂ [V²];
    ``step`` and ``fast`` those of the change of u from sample to sample, and of u above
    :data:`FAST`. ``last`` and ``slow`` are the last u and its slow part [V].
    ``fell``: whether the pendulum has been below the horizontal, in the whole run.
    """

    oscillation: OscillationSums = field(default_factory=OscillationSums)
    phi: float = 0.0
    command: float = 0.0
    error: float = 0.0
    step: float = 0.0
    fast: float = 0.0
    last: float = 0.0
    slow: float = 0.0
    fell: bool = False


@dataclass
class LoopMemory:
    """What a loop remembers; ``torque`` [V] is that applied since the last measurement."""

    plant: PlantMemory = field(default_factory=PlantMemory)
    control: ControlMemory = field(default_factory=ControlMemory)
    torque: float = 0.0


class Loop(NamedTuple):
    """Parameters of plant, estimator, friction observer and controller."""

    plant: PlantParameters = PlantParameters()
    estimator: EstimatorParameters = EstimatorParameters()
    observer: ObserverParameters = ObserverParameters()
    controller: ControllerParameters = ControllerParameters()


class Record(NamedTuple):
    """Series of a run, one row per sample of ``sample_time`` [s].

    ``state`` (n, 4) true x, ``estimate`` (n, 5) of x and of the friction [V], ``friction`` (n,)
    true F [V], ``friction_estimate`` (n,) F̂ [V], ``command`` (n,) u [V], ``measurement`` (n, 5) of
    x, NaN where there is no sensor, and of the torque applied since the previous sample [V].
    """

    sample_time: float
    state: np.ndarray
    estimate: np.ndarray
    friction: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray
    measurement: np.ndarray

    @property
    def time(self) -> np.ndarray:
        """Time of each sample (n,) [s]."""
        return np.arange(len(self.command)) * self.sample_time


class Outcome(NamedTuple):
    """Result of a run over its settled part; ``fell`` refers to the whole run.

    ``period_s`` is the mean time between upward crossings of the midpoint, NaN without an
    oscillation. The midpoint is that of the motion in the second half of the transient part. Rms
    values are about zero: arm angle [rad], command [V], its change from sample to sample, its part
    above 50 Hz (first-order filter), error of the friction estimate F − F̂ [V].
    """

    phi_peak_to_peak_rad: float
    theta_peak_to_peak_rad: float
    period_s: float
    stuck_fraction: float
    phi_rms_rad: float
    command_rms_v: float
    command_step_v: float
    command_high_frequency_v: float
    friction_error_rms_v: float
    fell: bool
    steps: int


class Simulation:
    """Simulates a loop. Its parameters can be changed between two runs, as on the graph.

    Parameters that are only read at the start (initial state, seed, sample time) stay the same.
    """

    def __init__(self, loop: Loop) -> None:
        self._memory = new_memory(LoopMemory)
        self._memory["plant"] = initial_plant(loop.plant)
        self._noise = np.random.default_rng(loop.plant.seed)
        self._loop = loop
        self.loop = loop

    @property
    def state(self) -> np.ndarray:
        """Plant state (5,); it can be changed between two runs."""
        state: np.ndarray = self._memory["plant"]["x"][0]
        return state

    @property
    def loop(self) -> Loop:
        """The current parameters."""
        return self._loop

    @loop.setter
    def loop(self, loop: Loop) -> None:
        self._loop = loop
        self._plant = design_plant(loop.plant)
        self._control_system = design_control_system(loop.estimator, loop.observer, loop.controller)

    def run(self, seconds: float) -> Record:
        """Continue for ``seconds``, at least one sample, and keep the series."""
        record = _empty_record(self.loop.plant.sample_time, self._samples(seconds))
        self._run(seconds, SETTLED, record)
        return record

    def measure(self, seconds: float, settled: float = SETTLED) -> Outcome:
        """Continue for ``seconds`` and measure the last fraction ``settled``; keep no series."""
        return self._run(seconds, settled, _empty_record(self.loop.plant.sample_time, 0))

    def _samples(self, seconds: float) -> int:
        return max(1, round(seconds / self.loop.plant.sample_time))

    def _run(self, seconds: float, settled: float, record: Record) -> Outcome:
        """Continue for ``seconds``; write the series into ``record`` unless it has no rows."""
        samples = self._samples(seconds)
        measured = max(1, round(settled * samples))
        sums = new_memory(Sums)
        _run(
            self._memory,
            self._noise,
            self._plant,
            self._control_system,
            samples=samples,
            transient=samples - measured,
            record=record,
            sums=sums,
        )
        return summary(sums[0].item(), record.sample_time, samples, measured)


def summary(sums: tuple[Any, ...], sample_time: float, samples: int, measured: int) -> Outcome:
    """The outcome of a run of ``samples`` samples, of which the last ``measured`` count.

    ``sums`` are the fields of :class:`Sums`.
    """
    oscillation_sums, phi, command, error, step, fast, _, _, fell = sums
    motion = oscillation(OscillationSums(*oscillation_sums), sample_time)
    return Outcome(
        *motion,
        phi_rms_rad=sqrt(phi / measured),
        command_rms_v=sqrt(command / measured),
        command_step_v=sqrt(step / measured),
        command_high_frequency_v=sqrt(fast / measured),
        friction_error_rms_v=sqrt(error / measured),
        fell=fell,
        steps=samples,
    )


def simulate(loop: Loop, seconds: float) -> Record:
    """Run the loop for ``seconds`` from the plant's initial state and keep its series."""
    return Simulation(loop).run(seconds)


def outcome(loop: Loop, seconds: float, settled: float = SETTLED) -> Outcome:
    """Run the loop for ``seconds`` and measure the last fraction ``settled``; keep no series."""
    return Simulation(loop).measure(seconds, settled)


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
def measure_sample(
    sums: Sums, x: np.ndarray, u: float, friction: float, estimated: float, dt: float
) -> None:
    """Include a sample of ``dt`` [s] in what is measured: true state, u, F and F̂ [V]."""
    if sums.oscillation.samples == 0:
        sums.last = sums.slow = u
    fast = u - sums.slow
    sums.slow += fast * (FAST * dt / (1.0 + FAST * dt))
    sums.fast += fast * fast
    sums.step += (u - sums.last) * (u - sums.last)
    sums.last = u
    accumulate(sums.oscillation, x)
    sums.phi += x[PHI] * x[PHI]
    sums.command += u * u
    sums.error += (friction - estimated) * (friction - estimated)


@inlined
def note_fall(sums: Sums, x: np.ndarray) -> None:
    """Remember whether the pendulum has been below the horizontal."""
    if abs(x[THETA]) > 0.5 * np.pi:
        sums.fell = True


@compiled
def _run(
    memory: np.ndarray,
    generator: np.random.Generator,
    plant: Plant,
    control_system: ControlSystem,
    samples: int,
    transient: int,
    record: Record,
    sums: np.ndarray,
) -> None:
    """Run ``samples`` samples; the first ``transient`` are not measured."""
    measurement, estimate = np.empty(SIGNALS), np.empty(SIGNALS)
    noise = np.zeros(NOISE_CHANNELS)
    keep = len(record.command) > 0
    loop, result = memory[0], sums[0]
    x = loop.plant.x
    for k in range(samples):
        if not plant.sensors.ideal:
            for channel in range(NOISE_CHANNELS):
                noise[channel] = generator.standard_normal()
        read(loop.plant, noise, plant, measurement)
        measurement[APPLIED_TORQUE] = loop.torque
        estimated, u = control_sample(loop.control, measurement, control_system, estimate)
        friction = 0.0
        if keep or k >= transient:
            friction = true_friction(loop.plant, plant)
        if keep:
            record.state[k] = x[:RIGID_STATES]
            record.estimate[k] = estimate
            record.friction[k] = friction
            record.friction_estimate[k] = estimated
            record.command[k] = u
            record.measurement[k] = measurement
        if transient // 2 <= k < transient:
            accumulate_midpoint(result.oscillation, x)
        if k >= transient:
            measure_sample(result, x, u, friction, estimated, plant.sample_time)
        note_fall(result, x)
        loop.torque = move(loop.plant, u, plant)
