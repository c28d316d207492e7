"""Cuts recordings of a pendulum into segments, each with a first estimate of its first state."""

from collections.abc import Sequence

import numpy as np
from numpy.polynomial.polynomial import polyfit

from furuta.identification.bodies.body import Segments
from furuta.identification.regression.speeds import with_speeds
from furuta.identification.shooting.unknowns import ParameterValues
from furuta_model.compiled import compiled
from furuta_model.friction.lugre import highest_level, stretched, stribeck_level
from furuta_model.friction.parameters import Friction
from furuta_model.state import BRISTLE, PHI, PHI_DOT, PLANT_STATES, RIGID_STATES, THETA, THETA_DOT
from furuta_recordings.recording import Recording

# Largest speed [rad/s] of a recording that starts at rest.
LARGEST_REST_SPEED = 0.3
# Standard deviation of an initial state, in standard deviations of the noise. The state is
# measured with the same noise that is fitted next, so the measurement must hardly count.
INITIAL_SPREAD = 30.0
# Friction [V] that the bristle may carry at the start of a segment before the friction is known.
SMALLEST_LEVEL = 0.01
# While the lag is fitted, speeds do not count this many lags after the start of a segment.
SETTLING_LAGS = 2.0
# Duration [s] and fewest samples of the parabola through the first samples.
PARABOLA, PARABOLA_SAMPLES = 0.02, 5


def cut_into_segments(
    recordings: Sequence[Recording], window: float, scale: np.ndarray, values: ParameterValues
) -> Segments:
    """Cut recordings every ``window`` [s]; an infinite window gives one segment, the free run.

    ``scale`` (4,) is the residual of each channel that counts as one. The initial state of a free
    run that starts at rest is the measured one. For a free run that starts in motion, and for
    shorter segments, it is fitted, with a spread in proportion to the scale.
    """
    parts = [_cut(recording, window, scale, values) for recording in recordings]
    sizes = np.cumsum([0, *(len(recording.time) for recording in recordings)])
    starts, weights, initial, spread = zip(*parts, strict=True)
    bounds = [rows + size for rows, size in zip(starts, sizes, strict=False)]
    measured = np.concatenate([recording.measured for recording in recordings])
    return Segments(
        np.concatenate([recording.time for recording in recordings]),
        np.where(np.isfinite(measured), measured, 0.0),
        np.concatenate(weights),
        np.append(np.concatenate(bounds), sizes[-1]),
        np.repeat(np.arange(len(recordings)), [len(rows) for rows in starts]),
        np.concatenate(initial),
        np.concatenate(spread),
        tuple(recordings),
    )


def _cut(
    recording: Recording, window: float, scale: np.ndarray, values: ParameterValues
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Starts (s,), weights (n, 4), measured states at the starts (s, 5) and their spreads."""
    time = recording.time
    count = max(1, int((time[-1] - time[0]) // window)) if np.isfinite(window) else 1
    edges = time[0] + (time[-1] - time[0]) * np.arange(count) / count
    starts = np.searchsorted(time, edges - 1e-9)
    initial = _initial_states(recording, starts, values)
    spread = np.zeros((count, PLANT_STATES))
    if count > 1 or np.max(np.abs(initial[0, [PHI_DOT, THETA_DOT]])) > LARGEST_REST_SPEED:
        spread[:, :RIGID_STATES] = INITIAL_SPREAD * scale
        level = max(values["coulomb"] + values["alpha1"], SMALLEST_LEVEL)
        spread[:, BRISTLE] = 0.5 * level / values["sigma0"]
    weight = np.where(np.isfinite(recording.measured), 1.0 / scale, 0.0)
    if count > 1:
        since = time - time[starts[np.searchsorted(starts, np.arange(len(time)), "right") - 1]]
        unsettled = since < SETTLING_LAGS * values["lag"]
        weight[unsettled, PHI_DOT] = weight[unsettled, THETA_DOT] = 0.0
    return starts, weight, initial, spread


def _initial_states(
    recording: Recording, starts: np.ndarray, values: ParameterValues
) -> np.ndarray:
    """Measured states (s, 5) at the starts; the bristle is driven by the measured speed."""
    speeds = with_speeds(recording, values["lag"])
    initial = np.zeros((len(starts), PLANT_STATES))
    initial[:, :RIGID_STATES] = speeds.measured[starts]
    for row, start in zip(initial, starts, strict=True):
        # The angles are those of a parabola through the first samples.
        end = np.searchsorted(recording.time, recording.time[start] + PARABOLA)
        if end - start < PARABOLA_SAMPLES:
            continue
        t = recording.time[start:end] - recording.time[start]
        for angle in (PHI, THETA):
            row[angle] = polyfit(t, recording.measured[start:end, angle], 2)[0]
    bristle = bristle_along(recording.time, speeds.measured[:, PHI_DOT].copy(), values.friction)
    initial[:, BRISTLE] = bristle[starts]
    return initial


@compiled
def bristle_along(time: np.ndarray, v: np.ndarray, friction: Friction) -> np.ndarray:
    """The bristle's deflection (n,) [rad] driven by the speed v (n,) [rad/s]."""
    z = np.zeros(len(time))
    limit = highest_level(friction) / friction.sigma0
    for k in range(len(time) - 1):
        mean = 0.5 * (v[k] + v[k + 1])
        dt, level = time[k + 1] - time[k], stribeck_level(mean, friction)
        end, _, _ = stretched(mean, mean, z[k], dt, level, friction)
        z[k + 1] = min(max(end, -limit), limit)
    return z
