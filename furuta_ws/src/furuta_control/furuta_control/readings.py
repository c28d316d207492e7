"""Checks every reading before the estimator uses it, and replaces those that it cannot use.

A reading is *missing* (NaN), *impossible* (beyond what the sensor can say), *clipped* (at the end
of the sensor's range, so the true value is anywhere beyond) or an *outlier* (too far from the
previous reading for anything that moves). None of these is a measurement. A few of them cost only
themselves, because the estimator uses its prediction instead. The estimate is lost after
:data:`PATIENCE` without a usable reading of one sensor, or when the pendulum leaves the range of
its sensor. It starts anew as soon as all sensors give usable readings.
"""

from dataclasses import dataclass
from math import ceil, pi, sqrt
from typing import NamedTuple

import numpy as np

from furuta_control.estimators.method import NominalRig
from furuta_model.block import zeros
from furuta_model.compiled import compiled, inlined
from furuta_model.sensors import Sensors, end_of_range
from furuta_model.state import (
    APPLIED_TORQUE,
    LARGEST_VALUE,
    PHI_DOT,
    SIGNALS,
    THETA,
    THETA_DOT,
)

# Time [s] without a usable reading of a sensor after which the estimate is lost: the upright
# pendulum hardly falls in it.
PATIENCE = 0.02
# Largest change between two readings that is no outlier, besides motion and noise [rad, rad/s].
ARM_JUMP = 0.5
ARM_SPEED_JUMP = 2.0
PENDULUM_JUMP = 0.1
# No rig moves faster [rad/s, rad/s, rad/s²].
HIGHEST_ARM_SPEED = 50.0
HIGHEST_PENDULUM_SPEED = 20.0
HIGHEST_ACCELERATION = 1000.0
# Standard deviations of a sensor's noise that are no outlier.
DEVIATIONS = 10.0
# Tolerance for rounding, relative.
ROUNDING = 1e-9


@dataclass
class ReadingMemory:
    """The last reading of each signal as used, and how many in a row could not be used."""

    last: np.ndarray = zeros(SIGNALS)
    unusable: np.ndarray = zeros(SIGNALS)


class ReadingLimits(NamedTuple):
    """What the readings can be; arrays (5,) in the order of a measurement.

    Attributes:
        measured: 1 if the signal is measured at all, otherwise 0.
        jump: Largest change from one sample to the next that is no outlier.
        end: Size at which the sensor clips.
        largest: Largest size that the sensor can give.
        full_turn: Whether the pendulum's sensor covers the circle; its angle jumps by 2π at ±π.
        patience: Number of unusable readings in a row that are replaced.
    """

    measured: np.ndarray
    jump: np.ndarray
    end: np.ndarray
    largest: np.ndarray
    full_turn: bool
    patience: int


def reading_limits(rig: NominalRig, needs_applied_torque: bool) -> ReadingLimits:
    """The limits for a rig. Ideal sensors have no range and no outliers."""
    sensors, dt = rig.sensors, rig.sample_time
    measured = np.ones(SIGNALS, dtype=np.int64)
    measured[THETA_DOT], measured[APPLIED_TORQUE] = sensors.ideal, needs_applied_torque
    jump, end, largest = (np.full(SIGNALS, LARGEST_VALUE) for _ in range(3))
    full_turn = sensors.potentiometer_range >= pi
    if not sensors.ideal:
        jump[: THETA + 1] = _largest_changes(sensors, dt)
        end[PHI_DOT] = end_of_range(sensors.tachometer_range, sensors.tachometer_bits)
        largest[PHI_DOT] = sensors.tachometer_range * (1.0 + ROUNDING)
        if not full_turn:
            end[THETA] = end_of_range(sensors.potentiometer_range, sensors.potentiometer_bits)
            largest[THETA] = sensors.potentiometer_range * (1.0 + ROUNDING)
    return ReadingLimits(
        measured=measured,
        jump=jump,
        end=end * (1.0 - ROUNDING),
        largest=largest,
        full_turn=full_turn and not sensors.ideal,
        patience=max(2, ceil(PATIENCE / dt * (1.0 - ROUNDING))),
    )


def _largest_changes(sensors: Sensors, dt: float) -> tuple[float, float, float]:
    """Largest change of φ [rad], φ̇ [rad/s] and θ [rad] in a sample that is no outlier."""
    speed_change = HIGHEST_ACCELERATION * dt
    arm_noise, speed_noise, pendulum_noise = map(sqrt, sensors.variances)
    return (
        ARM_JUMP + (HIGHEST_ARM_SPEED + 0.5 * speed_change) * dt + DEVIATIONS * arm_noise,
        ARM_SPEED_JUMP + speed_change + DEVIATIONS * speed_noise,
        PENDULUM_JUMP
        + (HIGHEST_PENDULUM_SPEED + 0.5 * speed_change) * dt
        + DEVIATIONS * pendulum_noise,
    )


@inlined
def all_usable(memory: ReadingMemory, measurement: np.ndarray, p: ReadingLimits) -> bool:
    """Whether every reading is usable."""
    usable = True
    for i in range(SIGNALS):
        usable &= p.measured[i] == 0 or _usable(measurement[i], memory.last[i], i, p)
    return usable


@inlined
def remember(memory: ReadingMemory, measurement: np.ndarray) -> None:
    """Keep the readings of this sample for the check of the next."""
    for i in range(SIGNALS):
        memory.last[i] = measurement[i]


@inlined
def forget_unusable(memory: ReadingMemory) -> None:
    """All readings of this sample are usable."""
    for i in range(SIGNALS):
        memory.unusable[i] = 0.0


@compiled
def can_start(measurement: np.ndarray, p: ReadingLimits) -> bool:
    """Whether an estimate can start from this measurement alone."""
    for i in range(SIGNALS):  # noqa: SIM110 (numba compiles no generators)
        if p.measured[i] and not abs(measurement[i]) < p.end[i]:
            return False
    return True


@compiled
def cross_seam(memory: ReadingMemory, measurement: np.ndarray) -> float:
    """Multiple of 2π [rad] by which a sensor of the full circle has jumped since the last sample.

    It is to be added to everything that the estimator remembers of θ.
    """
    turns = np.floor((measurement[THETA] - memory.last[THETA]) / (2.0 * np.pi) + 0.5)
    return 2.0 * np.pi * turns if abs(turns) == 1.0 else 0.0


@compiled
def replace_unusable(
    memory: ReadingMemory, measurement: np.ndarray, predicted: np.ndarray, p: ReadingLimits
) -> bool:
    """Replace unusable readings by the ``predicted`` ones (5,); false if the estimate is lost."""
    lost = False
    for i in range(SIGNALS):
        if not p.measured[i] or _usable(measurement[i], memory.last[i], i, p):
            memory.unusable[i] = 0.0
            continue
        memory.unusable[i] += 1.0
        clipped = p.end[i] <= abs(measurement[i]) <= p.largest[i]
        beyond = clipped and predicted[i] * np.sign(measurement[i]) >= p.end[i]
        if beyond and i == PHI_DOT:
            # The reading agrees with the prediction, so it can last.
            memory.unusable[i] = min(memory.unusable[i], 1.0)
        elif memory.unusable[i] > p.patience or (beyond and i == THETA):
            lost = True
        lost = lost or not abs(predicted[i]) < LARGEST_VALUE
    if lost:
        return False
    for i in range(SIGNALS):
        if memory.unusable[i] > 0.0:
            measurement[i] = predicted[i]
    return True


@inlined
def _usable(reading: float, previous: float, i: int, p: ReadingLimits) -> bool:
    """Whether a reading is a measurement; any is after a signal that was not measured (NaN)."""
    return abs(reading) < p.end[i] and not abs(reading - previous) > p.jump[i]


@compiled
def unknown_state(measurement: np.ndarray, estimate: np.ndarray, p: ReadingLimits) -> None:
    """Write what the readings alone say into ``estimate`` (5,): NaN for all that is unknown.

    A clipped pendulum angle is written as it is read, because the angle is at least that large.
    """
    for i in range(SIGNALS):
        known = p.measured[i] and i != APPLIED_TORQUE and abs(measurement[i]) < p.end[i]
        at_end = i == THETA and abs(measurement[i]) <= p.largest[i]
        estimate[i] = measurement[i] if known or at_end else np.nan
