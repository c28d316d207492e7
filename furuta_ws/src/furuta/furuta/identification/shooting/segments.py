"""Segments of a recording: the state at the start of each, and the algebra of these states.

A residual vector (4n + 5s,) of a recording has the n samples of four channels, then the five
initial states of s segments.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial.polynomial import polyfit

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
# Duration [s] and fewest samples of the parabola through the first samples.
PARABOLA, PARABOLA_SAMPLES = 0.02, 5


class Segments(NamedTuple):
    """A recording with the starts (s,) of its segments and the measured state at each (s, 5).

    ``spread`` (s, 5) is the standard deviation of that state; 0 if the state is not fitted.
    ``scale`` (4,) is the residual of each channel that counts as one.
    """

    recording: Recording
    starts: np.ndarray
    measured: np.ndarray
    spread: np.ndarray
    scale: np.ndarray

    @property
    def index_of_samples(self) -> np.ndarray:
        """The segment that each sample belongs to (n,)."""
        return np.searchsorted(self.starts, np.arange(len(self.recording.time)), "right") - 1


def cut_into_segments(
    recording: Recording, window: float, noise: np.ndarray, values: ParameterValues
) -> Segments:
    """Cut a recording every ``window`` [s]; an infinite window gives one segment, the free run.

    The initial state of a free run that starts at rest is the measured one. For a free run that
    starts in motion, and for shorter segments, it is fitted, with a spread in proportion to
    ``noise`` (4,).
    """
    time = recording.time
    count = max(1, int((time[-1] - time[0]) // window)) if np.isfinite(window) else 1
    edges = time[0] + (time[-1] - time[0]) * np.arange(count) / count
    starts = np.searchsorted(time, edges - 1e-9)
    initial = _initial_states(recording, starts, values)
    spread = np.zeros((count, PLANT_STATES))
    if count > 1 or np.max(np.abs(initial[0, [PHI_DOT, THETA_DOT]])) > LARGEST_REST_SPEED:
        spread[:, :RIGID_STATES] = INITIAL_SPREAD * noise
        level = max(values["coulomb"] + values["alpha1"], SMALLEST_LEVEL)
        spread[:, BRISTLE] = 0.5 * level / values["sigma0"]
    return Segments(recording, starts, initial, spread, noise)


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


def segment_rows(part: Segments) -> list[np.ndarray]:
    """The rows of each segment in a residual vector."""
    n = len(part.recording.time)
    first = RIGID_STATES * np.append(part.starts, n)
    own = RIGID_STATES * n + PLANT_STATES * np.arange(len(part.starts) + 1)
    return [
        np.append(np.arange(first[s], first[s + 1]), np.arange(own[s], own[s + 1]))
        for s in range(len(part.starts))
    ]


def sums_of_squares(residuals: np.ndarray, part: Segments) -> np.ndarray:
    """Sum of squares of each segment (s,)."""
    outputs = RIGID_STATES * len(part.recording.time)
    squares = residuals**2
    sums: np.ndarray = np.add.reduceat(squares[:outputs], RIGID_STATES * part.starts)
    return sums + squares[outputs:].reshape(len(part.starts), -1).sum(axis=1)


def gauss_newton_steps(slopes: np.ndarray, residuals: np.ndarray, part: Segments) -> np.ndarray:
    """Step (s, 5) of each initial state, given the slopes (4n + 5s, 5) in all of them."""
    steps = np.zeros((len(part.starts), PLANT_STATES))
    for step, rows in zip(steps, segment_rows(part), strict=True):
        step[:] = np.linalg.lstsq(slopes[rows], residuals[rows], rcond=None)[0]
    return steps


def without_initial_states(columns: np.ndarray, slopes: np.ndarray, part: Segments) -> np.ndarray:
    """``columns`` minus the part that a change of each segment's initial state can explain."""
    result = columns.copy()
    for rows in segment_rows(part):
        basis, _ = np.linalg.qr(slopes[rows])
        result[rows] -= basis @ (basis.T @ columns[rows])
    return result
