"""The digital-to-analogue converter of the drive: limits and quantises a command."""

from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.elementary import power_of_two
from furuta_model.parameters import OFF_AT_ZERO, About


class Actuator(NamedTuple):
    """Drive of the arm's motor, with a digital-to-analogue converter."""

    voltage_range: Annotated[float, About("largest voltage of the drive", "V", 1e-3, 1e3)] = 10.0
    bits: Annotated[
        int, About("bits of the drive's converter, 0 for no quantisation", "", 0, 32), OFF_AT_ZERO
    ] = 12


@inlined
def convert(value: float, full_scale: float, bits: int) -> float:
    """Clip and round ``value`` like a converter of ±``full_scale`` with ``bits``."""
    value = min(max(value, -full_scale), full_scale)
    if bits == 0:
        return value
    # Multiplication by a power of two is exact, and much faster than division.
    step = full_scale * power_of_two(1 - bits)
    code = np.floor(value / step + 0.5)
    return min(code, power_of_two(bits - 1) - 1.0) * step


@inlined
def drive(command: float, actuator: Actuator) -> float:
    """Torque [V] that the drive applies for a command [V]."""
    return convert(command, actuator.voltage_range, actuator.bits)
