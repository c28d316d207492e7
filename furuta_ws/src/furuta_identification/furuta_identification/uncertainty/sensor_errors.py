"""Quantisation and noise of the sensors, estimated from a recording and simulated."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_recordings.recording import Recording

# Samples needed to estimate a channel's noise.
FEWEST_SAMPLES = 10
# No sensor is better than this [rad, rad/s, rad, rad/s].
SMALLEST_NOISE = (1e-5, 1e-4, 1e-5, 1e-4)


class SensorErrors(NamedTuple):
    """Quantisation step (4,), 0 for a channel without, and standard deviation of noise (4,)."""

    step: np.ndarray
    noise: np.ndarray


def sensor_errors(recording: Recording) -> SensorErrors:
    """Steps by the smallest change of each channel, noise by its third differences.

    Third differences of a smooth motion are negligible; those of white noise have 20 times its
    variance.
    """
    step, noise = np.zeros(4), np.array(SMALLEST_NOISE)
    for channel, column in enumerate(recording.measured.T):
        series = column[np.isfinite(column)]
        if len(series) < FEWEST_SAMPLES:
            continue
        changes = np.abs(np.diff(series))
        smallest = float(np.min(changes[changes > 1e-12], initial=np.inf))
        step[channel] = smallest if np.isfinite(smallest) else 0.0
        variance = float(np.mean(np.diff(series, n=3) ** 2) / 20.0)
        variance -= step[channel] ** 2 / 12.0
        noise[channel] = max(noise[channel], np.sqrt(max(0.0, variance)))
    return SensorErrors(step, noise)


def noise_of(recording: Recording) -> np.ndarray:
    """Standard deviation of each channel's error (4,); 1 where nothing was measured."""
    step, noise = sensor_errors(recording)
    size = np.sqrt(noise**2 + step**2 / 12.0)
    return np.where(np.isfinite(recording.measured).any(axis=0), size, 1.0)


def measured_again(
    motion: np.ndarray, errors: SensorErrors, rng: np.random.Generator
) -> np.ndarray:
    """The ``motion`` (n, 4) as measured with new noise and another offset of the quantisation."""
    measured = motion + errors.noise * rng.standard_normal(motion.shape)
    for channel in np.flatnonzero(errors.step):
        step = errors.step[channel]
        offset = rng.uniform(0.0, step)
        measured[:, channel] = step * np.round((measured[:, channel] - offset) / step) + offset
    return measured
