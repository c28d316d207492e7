"""What is measured on an oscillation: size, period, time at rest.

Sample by sample, so that a run of any length needs the same few numbers: an array of METER_SIZE,
which first finds the middle of the motion, then accumulates. In a run these are two parts
that follow each other, of a recorded series the same part twice.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA

# Part of the peak-to-peak value that a crossing of the middle must go beyond to count.
HYSTERESIS = 0.1
# Arm speed [rad/s] below which the arm counts as stuck. LuGre never stands still: while it sticks
# it creeps through the bristle's deflection, 5 mrad from end to end in about half a second.
STUCK_SPEED = 1e-2
# Arm amplitude [rad] below which there is no oscillation to time.
SMALLEST_OSCILLATION = 1e-6

# What a meter holds.
_LOOKS = 0
_LOW = 1  # extremes of φ where the middle was looked for
_HIGH = 2
_SAMPLES = 3
_STUCK = 4
_PHI_LOW = 5
_PHI_HIGH = 6
_THETA_LOW = 7
_THETA_HIGH = 8
_BEFORE = 9  # φ of the last sample
_BELOW = 10  # whether φ has been well below the middle since its last upward crossing
_CROSSINGS = 11
_FIRST = 12  # sample of the first and of the last upward crossing
_LAST = 13
METER_SIZE = 14


class Oscillation(NamedTuple):
    """Size of a motion: peak to peak [rad], period [s] (NaN without one), part of time stuck."""

    phi_peak_to_peak_rad: float
    theta_peak_to_peak_rad: float
    period_s: float
    stuck_fraction: float


@compiled
def find_midpoint(meter: np.ndarray, x: np.ndarray) -> None:
    """Look where the middle of the arm's motion is; ``meter`` is (METER_SIZE,), zeros at first."""
    if meter[_LOOKS] == 0.0:
        meter[_LOW] = meter[_HIGH] = x[PHI]
    meter[_LOW] = min(meter[_LOW], x[PHI])
    meter[_HIGH] = max(meter[_HIGH], x[PHI])
    meter[_LOOKS] += 1.0


@compiled
def accumulate(meter: np.ndarray, x: np.ndarray) -> None:
    """Take one sample's true state ``x`` (4 or more) into a ``meter`` that has looked."""
    phi, theta = x[PHI], x[THETA]
    if meter[_SAMPLES] == 0.0:
        meter[_PHI_LOW] = meter[_PHI_HIGH] = meter[_BEFORE] = phi
        meter[_THETA_LOW] = meter[_THETA_HIGH] = theta
    meter[_PHI_LOW] = min(meter[_PHI_LOW], phi)
    meter[_PHI_HIGH] = max(meter[_PHI_HIGH], phi)
    meter[_THETA_LOW] = min(meter[_THETA_LOW], theta)
    meter[_THETA_HIGH] = max(meter[_THETA_HIGH], theta)
    if abs(x[PHI_DOT]) < STUCK_SPEED:
        meter[_STUCK] += 1.0
    _count_crossing(meter, phi)
    meter[_BEFORE] = phi
    meter[_SAMPLES] += 1.0


@compiled
def _count_crossing(meter: np.ndarray, phi: float) -> None:
    """Count an upward crossing of the middle after a visit well below it."""
    middle = 0.5 * (meter[_LOW] + meter[_HIGH])
    before, after = meter[_BEFORE] - middle, phi - middle
    if after < -HYSTERESIS * (meter[_HIGH] - meter[_LOW]):
        meter[_BELOW] = 1.0
    elif before < 0.0 <= after and meter[_BELOW] == 1.0:
        meter[_BELOW] = 0.0
        meter[_LAST] = meter[_SAMPLES] - 1.0 + before / (before - after)
        if meter[_CROSSINGS] == 0.0:
            meter[_FIRST] = meter[_LAST]
        meter[_CROSSINGS] += 1.0


def oscillation(meter: np.ndarray, sample_time: float) -> Oscillation:
    """What ``meter`` has seen, sampled every ``sample_time`` [s]."""
    samples, crossings = meter[_SAMPLES], meter[_CROSSINGS]
    size = float(meter[_PHI_HIGH] - meter[_PHI_LOW])
    timed = crossings >= 2 and meter[_HIGH] - meter[_LOW] >= SMALLEST_OSCILLATION
    period_s = (meter[_LAST] - meter[_FIRST]) / (crossings - 1) * sample_time if timed else np.nan
    return Oscillation(
        size,
        float(meter[_THETA_HIGH] - meter[_THETA_LOW]),
        float(period_s),
        float(meter[_STUCK] / max(1.0, samples)),
    )


def measure_oscillation(state: np.ndarray, sample_time: float) -> Oscillation:
    """Measure on the true state (n, 4), sampled every ``sample_time`` [s], transients cut off."""
    meter = np.zeros(METER_SIZE)
    _observe_series(meter, np.ascontiguousarray(state, dtype=float))
    return oscillation(meter, sample_time)


@compiled
def _observe_series(meter: np.ndarray, state: np.ndarray) -> None:
    for x in state:
        find_midpoint(meter, x)
    for x in state:
        accumulate(meter, x)


def period(signal: np.ndarray, sample_time: float) -> float:
    """Mean time [s] between upward crossings of the middle, NaN with fewer than two."""
    state = np.zeros((len(signal), RIGID_STATES))
    state[:, PHI] = signal
    return measure_oscillation(state, sample_time).period_s


def fell(state: np.ndarray) -> bool:
    """Whether the pendulum was ever below the horizontal."""
    return bool(np.any(np.abs(state[:, THETA]) > 0.5 * np.pi))
