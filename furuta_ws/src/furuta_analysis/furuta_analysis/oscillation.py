"""What is measured on an oscillation: size, period, time at rest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_model.state import PHI, PHI_DOT, THETA

# Part of the peak-to-peak value that a crossing of the middle must go beyond to count.
HYSTERESIS = 0.1
# Arm speed [rad/s] below which the arm counts as stuck. LuGre never stands still: while it sticks
# it creeps through the bristle's deflection, 5 mrad from end to end in about half a second.
STUCK_SPEED = 1e-2
# Arm amplitude [rad] below which there is no oscillation to time.
SMALLEST_OSCILLATION = 1e-6


class Oscillation(NamedTuple):
    """Size of a motion: peak to peak [rad], period [s] (NaN without one), part of time stuck."""

    phi_peak_to_peak_rad: float
    theta_peak_to_peak_rad: float
    period_s: float
    stuck_fraction: float


def measure_oscillation(state: np.ndarray, sample_time: float) -> Oscillation:
    """Measure on the true state (n, 4), sampled every ``sample_time`` [s], transients cut off."""
    phi = state[:, PHI]
    return Oscillation(
        float(np.ptp(phi)),
        float(np.ptp(state[:, THETA])),
        period(phi, sample_time),
        float(np.mean(np.abs(state[:, PHI_DOT]) < STUCK_SPEED)),
    )


def period(signal: np.ndarray, sample_time: float) -> float:
    """Mean time [s] between upward crossings of the middle, NaN with fewer than two."""
    low, high = float(np.min(signal)), float(np.max(signal))
    if high - low < SMALLEST_OSCILLATION:
        return float("nan")
    centred = signal - 0.5 * (low + high)
    band = HYSTERESIS * (high - low)
    crossings: list[float] = []
    below = False
    candidates = (np.abs(centred[1:]) > band) | (centred[:-1] < 0) & (centred[1:] >= 0)
    for index in map(int, np.flatnonzero(candidates)):
        before, after = centred[index], centred[index + 1]
        if before < 0 <= after and below:
            crossings.append(index + float(before / (before - after)))
            below = False
        elif after < -band:
            below = True
    if len(crossings) < 2:
        return float("nan")
    return (crossings[-1] - crossings[0]) / (len(crossings) - 1) * sample_time


def fell(state: np.ndarray) -> bool:
    """Whether the pendulum was ever below the horizontal."""
    return bool(np.any(np.abs(state[:, THETA]) > 0.5 * np.pi))
