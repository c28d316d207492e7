"""What sensors make of a motion, as far as a recording shows it: counts and noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_recordings.recording import Recording

# Samples from which a channel's noise can be told.
FEWEST = 10
# Nothing is measured better than this [rad, rad/s, rad, rad/s].
SMALLEST_NOISE = (1e-5, 1e-4, 1e-5, 1e-4)


class Sensor(NamedTuple):
    """Size of a count (4,), 0 for a channel without, and of the noise (4,)."""

    step: np.ndarray
    noise: np.ndarray


def sensor_of(recording: Recording) -> Sensor:
    """Counts by the smallest step of each channel, noise by what no smooth curve follows."""
    step, noise = np.zeros(4), np.array(SMALLEST_NOISE)
    for channel, column in enumerate(recording.measured.T):
        series = column[np.isfinite(column)]
        if len(series) < FEWEST:
            continue
        steps = np.abs(np.diff(series))
        smallest = float(np.min(steps[steps > 1e-12], initial=np.inf))
        step[channel] = smallest if np.isfinite(smallest) else 0.0
        rough = float(np.mean(np.diff(series, n=3) ** 2) / 20.0)
        rough -= step[channel] ** 2 / 12.0
        noise[channel] = max(noise[channel], np.sqrt(max(0.0, rough)))
    return Sensor(step, noise)


def noise_of(recording: Recording) -> np.ndarray:
    """Size of each channel's error (4,), counts and noise; 1 where nothing was measured."""
    step, noise = sensor_of(recording)
    size = np.sqrt(noise**2 + step**2 / 12.0)
    return np.where(np.isfinite(recording.measured).any(axis=0), size, 1.0)


def seen_again(motion: np.ndarray, sensor: Sensor, rng: np.random.Generator) -> np.ndarray:
    """The ``motion`` (n, 4) as the sensor might see it another time, its counts begun elsewhere."""
    seen = motion + sensor.noise * rng.standard_normal(motion.shape)
    for channel in np.flatnonzero(sensor.step):
        count = sensor.step[channel]
        start = rng.uniform(0.0, count)
        seen[:, channel] = count * np.round((seen[:, channel] - start) / count) + start
    return seen
