"""Quantisation and noise of the sensors, estimated from a recording."""

import numpy as np

from furuta_recordings.recording import Recording

# Samples needed to estimate a channel's noise.
FEWEST_SAMPLES = 10
# No sensor is better than this [rad, rad/s, rad, rad/s].
SMALLEST_NOISE = (1e-5, 1e-4, 1e-5, 1e-4)


def quantisation_step(series: np.ndarray) -> float:
    """The smallest change of a series (n,); 0 if it never changes."""
    changes = np.abs(np.diff(series[np.isfinite(series)]))
    smallest = float(np.min(changes[changes > 1e-12], initial=np.inf))
    return smallest if np.isfinite(smallest) else 0.0


def noise_of(recording: Recording) -> np.ndarray:
    """Standard deviation of each channel's error (4,); 1 where nothing was measured.

    It is that of noise by third differences and that of quantisation. Third differences of a smooth
    motion are negligible; those of white noise have 20 times its variance.
    """
    size = np.ones(4)
    for channel, column in enumerate(recording.measured.T):
        series, smallest = column[np.isfinite(column)], SMALLEST_NOISE[channel]
        if len(series) >= FEWEST_SAMPLES:
            of_step = quantisation_step(series) ** 2 / 12.0
            variance = float(np.mean(np.diff(series, n=3) ** 2) / 20.0) - of_step
            size[channel] = np.sqrt(max(smallest, np.sqrt(max(0.0, variance))) ** 2 + of_step)
        elif len(series):
            size[channel] = smallest
    return size
