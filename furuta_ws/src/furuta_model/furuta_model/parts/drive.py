r"""Delay, dead band and first-order lag between the drive's converter and the torque.

The lag follows its exact solution. Over a sample the arm gets the mean torque, so the momentum is
exact. Within a sample the torque is constant; the error is that of a delay far below a sample.
"""

from typing import Annotated, NamedTuple

from furuta_model.compiled import compiled, inlined
from furuta_model.friction.lugre import decay_fractions
from furuta_model.parameters import About
from furuta_model.parts.plant_memory import DELAY_SLOTS, MAX_DELAY, PlantMemory


class Drive(NamedTuple):
    """Dynamics of the drive. The measurement contains its voltage, not the torque."""

    delay: Annotated[int, About("delay of the voltage", "samples", 0, MAX_DELAY)] = 0
    lag: Annotated[float, About("time constant of the torque, 0 for none", "s", 0, 1)] = 0.0
    dead_band: Annotated[
        float,
        About("voltage up to which there is no torque; above it only the excess acts", "V", 0, 10),
    ] = 0.0


@inlined
def mean_torque(memory: PlantMemory, voltage: float, dt: float, p: Drive) -> float:
    """Mean torque [V] over a sample of ``dt`` [s] at the drive's ``voltage`` [V]."""
    sample = memory.moved
    memory.voltages[sample % DELAY_SLOTS] = voltage
    if p.delay > 0:
        first, voltage = memory.voltages_from, 0.0
        if sample - p.delay >= first:
            voltage = memory.voltages[(sample - p.delay) % DELAY_SLOTS]
        elif sample >= p.delay:
            voltage = memory.voltages[first % DELAY_SLOTS]
    voltage = without_dead_band(voltage, p.dead_band)
    if p.lag == 0.0:
        memory.torque = voltage
        return voltage
    d = dt / p.lag
    to_end, to_mean = decay_fractions(d)
    step = d * (voltage - memory.torque)
    mean = memory.torque + step * to_mean
    memory.torque += step * to_end
    return mean


@compiled
def without_dead_band(voltage: float, width: float) -> float:
    """The part of a voltage beyond ±``width`` [V]."""
    if abs(voltage) <= width:
        return 0.0
    return voltage - width if voltage > 0.0 else voltage + width
