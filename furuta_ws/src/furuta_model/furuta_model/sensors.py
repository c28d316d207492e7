"""The rig's sensors and its drive, each with a converter.

The parameters of the sensors are true ones of the plant and nominal ones of the estimator.

The defaults are those of the paper's rig (Section 4). Values that the paper does not give are
assumed: the tachometer has the range of a ±10 V converter at 1 V s/rad, and each analogue channel
has noise with a standard deviation of one code, as specified for 12-bit boards of the time.
"""

from math import nan, pi
from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.elementary import power_of_two
from furuta_model.parameters import OFF_AT_ZERO, About
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

# Turns per radian.
PER_TURN = 1.0 / (2.0 * pi)


class Sensors(NamedTuple):
    """Encoder on the arm, tachometer on the arm, potentiometer on the pendulum."""

    ideal: Annotated[
        bool, About("measure all four states exactly and ignore the rest of this group")
    ] = False
    encoder_counts: Annotated[
        int,
        About("encoder pulses per revolution of the arm, 0 for no quantisation", "", 0, 2**24),
        OFF_AT_ZERO,
    ] = 250
    tachometer_range: Annotated[float, About("arm speed at full scale", "rad/s", 1e-3, 1e4)] = 10.0
    tachometer_bits: Annotated[
        int,
        About("bits of the tachometer's converter, 0 for no quantisation", "", 0, 32),
        OFF_AT_ZERO,
    ] = 12
    tachometer_noise: Annotated[
        float, About("standard deviation of the tachometer's noise", "rad/s", 0.0, 100.0)
    ] = 20.0 / 4096
    potentiometer_range: Annotated[
        float, About("pendulum angle at full scale", "rad", 1e-3, 2 * pi)
    ] = pi / 4
    potentiometer_bits: Annotated[
        int,
        About("bits of the potentiometer's converter, 0 for no quantisation", "", 0, 32),
        OFF_AT_ZERO,
    ] = 12
    potentiometer_noise: Annotated[
        float, About("standard deviation of the potentiometer's noise", "rad", 0.0, 1.0)
    ] = pi / 2 / 4096

    @property
    def encoder_count(self) -> float:
        """One count of the arm's encoder [rad], 0 without quantisation."""
        return 2.0 * pi / self.encoder_counts if self.encoder_counts else 0.0

    @property
    def variances(self) -> tuple[float, float, float]:
        """Variance of a reading of φ [rad²], φ̇ [rad²/s²] and θ [rad²], rounding included."""
        tachometer_step = step_size(self.tachometer_range, self.tachometer_bits)
        potentiometer_step = step_size(self.potentiometer_range, self.potentiometer_bits)
        return (
            variance(0.0, self.encoder_count),
            variance(self.tachometer_noise, tachometer_step),
            variance(self.potentiometer_noise, potentiometer_step),
        )


class Actuator(NamedTuple):
    """Drive of the arm's motor, with a digital-to-analogue converter."""

    voltage_range: Annotated[float, About("largest voltage of the drive", "V", 1e-3, 1e3)] = 10.0
    bits: Annotated[
        int, About("bits of the drive's converter, 0 for no quantisation", "", 0, 32), OFF_AT_ZERO
    ] = 12


def variance(noise: float, step: float) -> float:
    """Variance of a reading with noise of standard deviation ``noise``, rounded to steps."""
    return noise**2 + step**2 / 12.0


def step_size(full_scale: float, bits: int) -> float:
    """Step of a converter of ±``full_scale`` with ``bits``; 0 without quantisation."""
    return 2.0 * full_scale / 2**bits if bits else 0.0


def end_of_range(full_scale: float, bits: int) -> float:
    """Size of a reading at which a converter of ±``full_scale`` clips: its highest code."""
    return full_scale - step_size(full_scale, bits)


@inlined
def measure(x: np.ndarray, noise: np.ndarray, sensors: Sensors, measurement: np.ndarray) -> None:
    """Read sound sensors into the first 4 of ``measurement``; ``noise`` (2,) is standard normal.

    The measurement of θ̇ is NaN, because the rig has no sensor for it. ``x`` may be the measurement.
    """
    phi, v, theta, w = x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT]
    if sensors.ideal:
        measurement[PHI], measurement[PHI_DOT] = phi, v
        measurement[THETA], measurement[THETA_DOT] = theta, w
        return
    if sensors.encoder_counts > 0:
        count = 2.0 * pi / sensors.encoder_counts
        phi = np.floor(phi * (sensors.encoder_counts * PER_TURN) + 0.5) * count
    measurement[PHI] = phi
    measurement[PHI_DOT] = convert(
        v + sensors.tachometer_noise * noise[0],
        sensors.tachometer_range,
        sensors.tachometer_bits,
    )
    theta -= 2.0 * pi * np.floor(theta * PER_TURN + 0.5)
    measurement[THETA] = convert(
        theta + sensors.potentiometer_noise * noise[1],
        sensors.potentiometer_range,
        sensors.potentiometer_bits,
    )
    measurement[THETA_DOT] = nan


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
