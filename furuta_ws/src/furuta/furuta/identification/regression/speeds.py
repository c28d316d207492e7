"""Compares measured speeds with the slopes of the angles: lag, scale, replacement."""

import numpy as np

from furuta.identification.regression.windows import Windows
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import Recording

# Time [s] to either side of a sample over which the slope of an angle is taken.
REACH = 0.01
# Part of the largest arm speed that counts as motion in a direction.
MOVING_PART = 0.1


def speed_lag(recording: Recording) -> float:
    """How far measured arm speeds lag behind measured angles [s]; 0 if either is missing."""
    factor, lag = speed_as_slope(recording, PHI, PHI_DOT) or (1.0, 0.0)
    return float(np.clip(lag / (factor or 1.0), 0.0, 0.05))


def speed_as_slope(recording: Recording, angle: int, speed: int) -> tuple[float, float] | None:
    """(k, l) of: slope of the angle = k·speed + l·slope of the speed; None without motion."""
    v, position = recording.measured[:, speed], recording.measured[:, angle]
    if not np.all(np.isfinite(v)) or np.ptp(position) == 0.0 or not np.any(v):
        return None
    windows = Windows(recording.time)
    columns = np.array([windows.mean(v), windows.slope(v)]).T
    k, lag = np.linalg.lstsq(columns, windows.slope(position), rcond=None)[0]
    return float(k), float(lag)


def with_speeds(recording: Recording, lag: float, reach: float = REACH) -> Recording:
    """The recording with speeds ``lag`` [s] earlier; missing speeds are slopes of the angles.

    A slope is taken over the samples within ``reach`` [s] to either side.
    """
    time, measured = recording.time, recording.measured.copy()
    for angle, speed in ((PHI, PHI_DOT), (THETA, THETA_DOT)):
        if np.all(np.isfinite(measured[:, speed])):
            measured[:, speed] = np.interp(time + lag, time, measured[:, speed])
        else:
            measured[:, speed] = _slope(time, measured[:, angle], reach)
    return recording._replace(measured=measured)


def _slope(time: np.ndarray, angle: np.ndarray, seconds: float) -> np.ndarray:
    """Slope of a straight line through the samples within some ``seconds`` to either side."""
    reach = max(2, round(seconds / float(np.median(np.diff(time)))))
    reach = min(reach, len(time) // 2)
    time = time - time[0]  # squares of times since 1970 would lose the intervals
    kernel = np.ones(2 * reach + 1)
    pad = (reach, reach)
    t, y = np.pad(time, pad, mode="reflect", reflect_type="odd"), np.pad(angle, pad, mode="edge")
    y[:reach] = 2 * angle[0] - angle[reach:0:-1]
    y[-reach:] = 2 * angle[-1] - angle[-2 : -reach - 2 : -1]
    count = len(kernel)
    t_mean = np.convolve(t, kernel, "valid") / count
    y_mean = np.convolve(y, kernel, "valid") / count
    ty = np.convolve(t * y, kernel, "valid") / count - t_mean * y_mean
    tt = np.convolve(t * t, kernel, "valid") / count - t_mean * t_mean
    slope: np.ndarray = ty / tt
    return slope


def turns_one_way(recording: Recording) -> bool:
    """Whether the arm turns in one direction only."""
    v = with_speeds(recording, 0.0).measured[:, PHI_DOT]
    fast = MOVING_PART * np.max(np.abs(v))
    return not (np.any(v > fast) and np.any(v < -fast))
