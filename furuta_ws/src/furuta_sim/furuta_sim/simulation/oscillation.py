"""Measures an oscillation sample by sample: peak to peak, period, fraction of time stuck.

A run of any length needs one small array, the accumulator (ACCUMULATOR_SIZE,). It first accumulates
the midpoint of the motion and then everything else. In a run these are two successive parts; a
recorded series is passed twice.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA

# Fraction of the peak-to-peak value by which φ must go below the midpoint between crossings.
HYSTERESIS = 0.1
# Arm speed [rad/s] below which the arm counts as stuck. Under LuGre a stuck arm creeps through the
# deflection of the bristle, 5 mrad in about half a second.
STUCK_SPEED = 1e-2
# Peak to peak of the arm [rad] below which there is no period.
SMALLEST_OSCILLATION = 1e-6

# Indices of the accumulator.
_MIDPOINT_SAMPLES = 0
_MIDPOINT_LOW = 1  # extremes of φ that give the midpoint
_MIDPOINT_HIGH = 2
_SAMPLES = 3
_STUCK = 4
_PHI_LOW = 5
_PHI_HIGH = 6
_THETA_LOW = 7
_THETA_HIGH = 8
_PREVIOUS_PHI = 9
_WAS_BELOW = 10  # whether φ has been well below the midpoint since the last upward crossing
_CROSSINGS = 11
_FIRST_CROSSING = 12  # sample of the first and of the last upward crossing
_LAST_CROSSING = 13
ACCUMULATOR_SIZE = 14


class Oscillation(NamedTuple):
    """Peak to peak [rad], period [s] (NaN without one), fraction of time stuck."""

    phi_peak_to_peak_rad: float
    theta_peak_to_peak_rad: float
    period_s: float
    stuck_fraction: float


@inlined
def accumulate_midpoint(accumulator: np.ndarray, x: np.ndarray) -> None:
    """Include one sample in the midpoint of the arm's motion; the accumulator starts with zeros."""
    if accumulator[_MIDPOINT_SAMPLES] == 0.0:
        accumulator[_MIDPOINT_LOW] = accumulator[_MIDPOINT_HIGH] = x[PHI]
    accumulator[_MIDPOINT_LOW] = min(accumulator[_MIDPOINT_LOW], x[PHI])
    accumulator[_MIDPOINT_HIGH] = max(accumulator[_MIDPOINT_HIGH], x[PHI])
    accumulator[_MIDPOINT_SAMPLES] += 1.0


@inlined
def accumulate(accumulator: np.ndarray, x: np.ndarray) -> None:
    """Include the true state ``x`` (4 or more) of one sample, once the midpoint is known."""
    phi, theta = x[PHI], x[THETA]
    if accumulator[_SAMPLES] == 0.0:
        accumulator[_PHI_LOW] = accumulator[_PHI_HIGH] = accumulator[_PREVIOUS_PHI] = phi
        accumulator[_THETA_LOW] = accumulator[_THETA_HIGH] = theta
    accumulator[_PHI_LOW] = min(accumulator[_PHI_LOW], phi)
    accumulator[_PHI_HIGH] = max(accumulator[_PHI_HIGH], phi)
    accumulator[_THETA_LOW] = min(accumulator[_THETA_LOW], theta)
    accumulator[_THETA_HIGH] = max(accumulator[_THETA_HIGH], theta)
    if abs(x[PHI_DOT]) < STUCK_SPEED:
        accumulator[_STUCK] += 1.0
    _count_crossing(accumulator, phi)
    accumulator[_PREVIOUS_PHI] = phi
    accumulator[_SAMPLES] += 1.0


@inlined
def _count_crossing(accumulator: np.ndarray, phi: float) -> None:
    """Count an upward crossing of the midpoint if φ was well below it before."""
    midpoint = 0.5 * (accumulator[_MIDPOINT_LOW] + accumulator[_MIDPOINT_HIGH])
    before, after = accumulator[_PREVIOUS_PHI] - midpoint, phi - midpoint
    if after < -HYSTERESIS * (accumulator[_MIDPOINT_HIGH] - accumulator[_MIDPOINT_LOW]):
        accumulator[_WAS_BELOW] = 1.0
    elif before < 0.0 <= after and accumulator[_WAS_BELOW] == 1.0:
        accumulator[_WAS_BELOW] = 0.0
        accumulator[_LAST_CROSSING] = accumulator[_SAMPLES] - 1.0 + before / (before - after)
        if accumulator[_CROSSINGS] == 0.0:
            accumulator[_FIRST_CROSSING] = accumulator[_LAST_CROSSING]
        accumulator[_CROSSINGS] += 1.0


def oscillation(accumulator: np.ndarray, sample_time: float) -> Oscillation:
    """The oscillation in the accumulator, with samples every ``sample_time`` [s]."""
    samples, crossings = accumulator[_SAMPLES], accumulator[_CROSSINGS]
    phi_peak_to_peak = float(accumulator[_PHI_HIGH] - accumulator[_PHI_LOW])
    earlier_peak_to_peak = accumulator[_MIDPOINT_HIGH] - accumulator[_MIDPOINT_LOW]
    has_period = crossings >= 2 and earlier_peak_to_peak >= SMALLEST_OSCILLATION
    duration = accumulator[_LAST_CROSSING] - accumulator[_FIRST_CROSSING]
    period_s = duration / (crossings - 1) * sample_time if has_period else np.nan
    return Oscillation(
        phi_peak_to_peak,
        float(accumulator[_THETA_HIGH] - accumulator[_THETA_LOW]),
        float(period_s),
        float(accumulator[_STUCK] / max(1.0, samples)),
    )


def measure_oscillation(state: np.ndarray, sample_time: float) -> Oscillation:
    """Measure the true state (n, 4), sampled every ``sample_time`` [s], without transients."""
    accumulator = np.zeros(ACCUMULATOR_SIZE)
    _accumulate_series(accumulator, np.ascontiguousarray(state, dtype=float))
    return oscillation(accumulator, sample_time)


@compiled
def _accumulate_series(accumulator: np.ndarray, state: np.ndarray) -> None:
    for x in state:
        accumulate_midpoint(accumulator, x)
    for x in state:
        accumulate(accumulator, x)


def period(signal: np.ndarray, sample_time: float) -> float:
    """Mean time [s] between upward crossings of the midpoint; NaN with fewer than two."""
    state = np.zeros((len(signal), RIGID_STATES))
    state[:, PHI] = signal
    return measure_oscillation(state, sample_time).period_s


def fell(state: np.ndarray) -> bool:
    """Whether the pendulum was ever below the horizontal."""
    return bool(np.any(np.abs(state[:, THETA]) > 0.5 * np.pi))
