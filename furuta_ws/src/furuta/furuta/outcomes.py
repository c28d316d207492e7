"""Measures runs of a closed loop part by part: oscillation, rms values and falls, no series.

A run of any length needs the series of a part and one small memory, :class:`Sums`.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import inf, sqrt
from typing import Any

import numpy as np

from furuta.oscillation import (
    OscillationSums,
    accumulate,
    accumulate_midpoint,
    oscillation,
)
from furuta.results.result import Result
from furuta.results.text import swing_sentence
from furuta_control.excitation import ExcitationParameters
from furuta_model.block import new_memory
from furuta_model.compiled import compiled, inlined
from furuta_model.friction.parameters import Friction
from furuta_model.sensors import step_size
from furuta_model.state import HORIZONTAL, PHI, THETA
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.simulation.closed_loop import Loop, Record, Simulation

# Fraction of a run that is measured: the last half, after the transients.
SETTLED = 0.5
NO_MEANING = "The other values mean nothing."
# Samples that are kept at a time.
PART = 10_000
# Duration of a run that shows the swing caused by the sensors [s].
SENSORS_SECONDS = 30.0
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


@dataclass(frozen=True, repr=False)
class Outcome(Result):
    """What was measured of a run in its settled part; ``fell`` refers to the whole run.

    ``period_s`` is the mean time between upward crossings of the midpoint, NaN without an
    oscillation. The midpoint is that of the motion in the second half of the transient part.
    ``stuck_fraction`` is NaN without friction, where nothing holds the arm. Rms values are about
    zero: arm angle [rad], command [V], its change from sample to sample, its part above 50 Hz
    (first-order filter), error of the friction estimate F − F̂ [V].
    """

    details = frozenset({"steps"})

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

    def sentence(self) -> str:
        """How the arm swings."""
        if self.fell:
            return f"The pendulum fell. {NO_MEANING}"
        return swing_sentence(self.phi_peak_to_peak_rad, self.period_s, self.stuck_fraction)


def outcome(loop: Loop, seconds: float, settled: float = SETTLED) -> Outcome:
    """Run the loop for ``seconds`` and measure the last fraction ``settled``; keep no series."""
    return measure(Simulation(loop), seconds, settled)


def measure(simulation: Simulation, seconds: float, settled: float = SETTLED) -> Outcome:
    """Continue a simulation for ``seconds``, and measure the last fraction ``settled``."""
    plant, samples = simulation.loop.plant, simulation.samples(seconds)
    # To compile another loop, which measures as it runs, would take half a minute.
    parts = (
        simulation.run(min(PART, samples - begin) * plant.sample_time)
        for begin in range(0, samples, PART)
    )
    return outcome_of(parts, plant, samples, settled)


def outcome_of(
    parts: Iterable[Record], plant: PlantParameters, samples: int, settled: float = SETTLED
) -> Outcome:
    """Measure a run of ``samples`` samples that comes in parts; of one that is kept, in one."""
    measured = measured_samples(samples, settled)
    sums, begin = new_memory(Sums), 0
    for record in parts:
        _include(record, begin, samples - measured, sums)
        begin += len(record.command)
    return summary(sums[0].item(), plant, samples, measured)


def measured_samples(samples: int, settled: float) -> int:
    """How many of the samples of a run are its last fraction ``settled``."""
    return max(1, round(settled * samples))


def residual(run: Outcome) -> float:
    """The arm's angle, peak to peak [rad], in the settled part; infinite after a fall."""
    return inf if run.fell else run.phi_peak_to_peak_rad


def sensors_alone(loop: Loop) -> float:
    """Swing of the arm [rad], peak to peak, that quantisation and noise of the sensors cause.

    It is simulated without friction, compensation and disturbances, but with the drive's delay and
    the elasticity of the coupling. The pendulum is upright once at a code of its sensor and once
    between two; the larger swing counts. It is infinite if the pendulum falls.
    """
    runs = [outcome(_only_sensors(loop, part), SENSORS_SECONDS) for part in (0.0, 0.5)]
    return max(map(residual, runs))


def _only_sensors(loop: Loop, part: float) -> Loop:
    """The loop without friction; upright is that ``part`` of a code beside one."""
    plant, sensors = loop.plant, loop.plant.sensors
    step = step_size(sensors.potentiometer_range, sensors.potentiometer_bits)
    viscous = Friction(alpha0=0.0, alpha1=0.0, viscous=plant.friction.parameters.viscous)
    return loop._replace(
        plant=PlantParameters(
            model=plant.model,
            friction=PlantFriction("coulomb", viscous),
            sensors=sensors,
            actuator=plant.actuator,
            drive=plant.drive,
            coupling=plant.coupling._replace(backlash=0.0),
            pendulum_friction=plant.pendulum_friction._replace(coulomb=0.0),
            sensor_faults=plant.sensor_faults._replace(pendulum_bias=part * step),
            sample_time=plant.sample_time,
        ),
        observer=loop.observer._replace(compensation="none"),
        controller=loop.controller._replace(mode="balance", excitation=ExcitationParameters()),
    )


def summary(sums: tuple[Any, ...], plant: PlantParameters, samples: int, measured: int) -> Outcome:
    """The outcome of a run of ``samples`` samples, of which the last ``measured`` count.

    ``sums`` are the fields of :class:`Sums`.
    """
    oscillation_sums, phi, command, error, step, fast, _, _, fell = sums
    friction = plant.friction.parameters
    motion = oscillation(OscillationSums(*oscillation_sums), plant.sample_time, friction)
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
    if abs(x[THETA]) > HORIZONTAL:
        sums.fell = True


@compiled
def _include(record: Record, begin: int, transient: int, sums: np.ndarray) -> None:
    """Include a part of a run, from sample ``begin`` on; ``transient`` samples do not count."""
    result = sums[0]
    for i in range(len(record.command)):
        k, x, u = begin + i, record.state[i], record.command[i]
        if transient // 2 <= k < transient:
            accumulate_midpoint(result.oscillation, x)
        if k >= transient:
            friction, estimated = record.friction[i], record.friction_estimate[i]
            measure_sample(result, x, u, friction, estimated, record.sample_time)
        note_fall(result, x)
