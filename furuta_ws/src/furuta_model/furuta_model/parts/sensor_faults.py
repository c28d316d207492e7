"""Faults of the sensors: delay, bias, a stuck sensor, missing readings, a speed from counts.

Missing readings come from a stream of their own, a hash of seed, reading and signal: switching them
on leaves the sensors' noise as it is.
"""

from math import expm1
from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.late_drive import DELAY_SLOTS, MAX_DELAY
from furuta_model.parameters import About
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA

SENSORS = ("none", "encoder", "tachometer", "potentiometer")
SIGNALS_OF_SENSORS = (-1, PHI, PHI_DOT, THETA)


class SensorFaults(NamedTuple):
    """Faults, of ideal sensors too."""

    reading_delay: Annotated[int, About("delay of all readings", "samples", 0, MAX_DELAY)] = 0
    missing: Annotated[float, About("probability that a reading is missing", "", 0, 1)] = 0.0
    stuck: Annotated[str, About("sensor that repeats its reading", choices=SENSORS)] = "none"
    stuck_from: Annotated[float, About("time from which it is stuck", "s", 0, 1e6)] = 0.0
    arm_bias: Annotated[float, About("error of the arm angle", "rad", -10, 10)] = 0.0
    arm_speed_bias: Annotated[float, About("error of the arm speed", "rad/s", -10, 10)] = 0.0
    pendulum_bias: Annotated[float, About("error of the pendulum angle", "rad", -1, 1)] = 0.0
    speed_bandwidth: Annotated[
        float,
        About("filter on the difference of the arm's angles, 0: tachometer", "rad/s", 0, 1e5),
    ] = 0.0


class FaultySensors(NamedTuple):
    """The faults, as compiled code uses them; ``stuck_from`` [readings], ``bias`` of x (4,).

    ``on_motor``: encoder and tachometer are on the motor's side of an elastic coupling.
    ``speed_rate`` [1/s] is the share of a new value in the filtered speed, over the sample time.
    """

    is_active: bool
    delay: int
    missing: float
    stuck: int
    stuck_from: float
    bias: np.ndarray
    speed_share: float
    speed_rate: float
    on_motor: bool
    seed: int


def design_faults(p: SensorFaults, on_motor: bool, dt: float, seed: int) -> FaultySensors:
    """The faults for samples of ``dt`` [s]; sensors ``on_motor`` count as faulty."""
    share = -expm1(-p.speed_bandwidth * dt)
    return FaultySensors(
        on_motor or p._replace(stuck_from=0.0) != SensorFaults(),
        p.reading_delay,
        p.missing,
        SIGNALS_OF_SENSORS[SENSORS.index(p.stuck)],
        round(p.stuck_from / dt),
        np.array([p.arm_bias, p.arm_speed_bias, p.pendulum_bias, 0.0]),
        share,
        share / dt,
        on_motor,
        seed,
    )


@compiled
def sensed_state(memory: PlantMemory, i: int, on_motor: bool) -> float:
    """State i where its sensor is."""
    if on_motor and i == PHI:
        return memory.motor.angle
    if on_motor and i == PHI_DOT:
        return memory.motor.speed
    return memory.x[i]


@inlined
def faulty_state(memory: PlantMemory, i: int, p: FaultySensors) -> float:
    """State i as the sensors see it: some samples ago, with bias."""
    value = sensed_state(memory, i, p.on_motor)
    first = memory.states_from
    if p.delay > 0 and memory.readings > first:
        value = memory.states[max(memory.readings - p.delay, first) % DELAY_SLOTS, i]
    return value + p.bias[i]


@inlined
def apply_faults(memory: PlantMemory, measurement: np.ndarray, p: FaultySensors) -> None:
    """Repeat the reading of a stuck sensor and remove missing ones."""
    reading, angle = memory.readings, memory.last_reading[PHI]
    for i in range(RIGID_STATES):
        memory.states[reading % DELAY_SLOTS, i] = sensed_state(memory, i, p.on_motor)
        if i == PHI_DOT and p.speed_share > 0.0:
            measurement[i] = counted_speed(memory, angle, p)
        if i == p.stuck and reading >= max(p.stuck_from, memory.states_from + 1):
            measurement[i] = memory.last_reading[i]
        memory.last_reading[i] = measurement[i]
        if p.missing > 0.0 and uniform(p.seed, reading, i) < p.missing:
            measurement[i] = np.nan


@inlined
def counted_speed(memory: PlantMemory, angle: float, p: FaultySensors) -> float:
    """The filtered difference of the last reading of φ and the one before, ``angle`` [rad/s]."""
    if memory.readings == memory.states_from:
        return 0.0
    speed = memory.last_reading[PHI_DOT]
    return speed + p.speed_rate * (memory.last_reading[PHI] - angle) - p.speed_share * speed


@compiled
def uniform(seed: int, reading: int, signal: int) -> float:
    """A number in [0, 1) that depends on its arguments alone.

    SplitMix64 of their combination (G. L. Steele, D. Lea, C. H. Flood, *Fast splittable
    pseudorandom number generators*, 2014).
    """
    z = _mixed(np.uint64(seed))
    z = _mixed(z ^ np.uint64(reading))
    return float(_mixed(z ^ np.uint64(signal)) >> np.uint64(11)) * 2.0**-53


@compiled
def _mixed(z: np.uint64) -> np.uint64:
    """One output of SplitMix64."""
    z += np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
