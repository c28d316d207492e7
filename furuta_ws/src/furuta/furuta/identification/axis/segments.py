"""Cuts recordings of an axis into segments, each with a first estimate of its first state."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from furuta.identification.axis.motion import AxisData
from furuta.identification.bodies.body import Segments
from furuta.identification.errors import series_noise
from furuta_model.state import PHI
from furuta_recordings.recording import Recording

# Usual length of a segment [s], fewest samples in one, counts that the axis moves in one, fewest
# segments that are wanted.
LENGTH, FEWEST_SAMPLES, COUNTS, FEWEST = 0.5, 20, 30.0, 40
# Most samples and commands that are fitted.
MOST_SAMPLES = 60_000
# Longest step of the integration [s].
STEP = 1e-3
# Time [s] between two recordings on the common axis: no torque lasts so long.
BETWEEN = 100.0
# Counts over which the position is smoothed for the first states, and range of that time [s].
SMOOTHED, SHORTEST, LONGEST = 10.0, 0.01, 0.2


# A segment: the number of its recording, and its rows.
Cut = tuple[int, slice]


class Smoothed(NamedTuple):
    """A recording on an even grid: time, position, its two derivatives, and torque (n,)."""

    time: np.ndarray
    position: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray
    window: float


def position_noise(recording: Recording) -> float:
    """Standard deviation of a position [rad]."""
    return series_noise(recording.time, recording.measured[:, PHI]) or 1e-9


def smoothed(recording: Recording, window: float | None = None) -> Smoothed:
    """The recording on an even grid, smoothed by parabolas over ``window`` [s]."""
    from scipy.signal import savgol_filter

    position, time = recording.measured[:, PHI], recording.time
    step = max(recording.interval, 1e-4)
    grid = np.arange(time[0], time[-1], step)
    even = np.interp(grid, time, position)
    if window is None:
        count = np.sqrt(12.0) * position_noise(recording)
        speed = np.sqrt(np.mean(np.diff(_thinned(even, step)) ** 2)) / 0.02
        window = float(np.clip(SMOOTHED * count / max(speed, 1e-300), SHORTEST, LONGEST))
    size = min(max(round(window / step), 7) | 1, (len(even) - 1) | 1)
    wide = min(2 * size | 1, (len(even) - 1) | 1)
    return Smoothed(
        grid,
        savgol_filter(even, size, 3),
        savgol_filter(even, size, 3, deriv=1, delta=step),
        savgol_filter(even, wide, 3, deriv=2, delta=step),
        recording.commanded_at(grid),
        size * step,
    )


def _thinned(even: np.ndarray, step: float) -> np.ndarray:
    """About one value in 20 ms."""
    return even[:: max(round(0.02 / step), 1)]


def segmented(recordings: Sequence[Recording], length: float | None = None) -> Segments:
    """Recordings on one time axis, cut into segments of a ``length`` [s]; None chooses it."""
    noise = float(np.median([position_noise(recording) for recording in recordings]))
    length = length or segment_length(recordings, noise)
    recordings = _on_one_axis(recordings)
    edges, torques = zip(*map(_commands, recordings), strict=True)
    cuts = [(number, rows) for number, r in enumerate(recordings) for rows in _cut(r, length)]
    size = max(sum(rows.stop - rows.start for _, rows in cuts), sum(map(len, edges)))
    cuts = _spread_over(cuts, max(MOST_SAMPLES * len(cuts) // size, FEWEST))
    smooth = [smoothed(recording) for recording in recordings]
    starts = [(smooth[k], recordings[k].time[rows.start]) for k, rows in cuts]
    states = np.array([_first_state(*start, noise) for start in starts])
    position = np.concatenate([recordings[k].measured[rows, PHI] for k, rows in cuts])
    return Segments(
        np.concatenate([recordings[k].time[rows] for k, rows in cuts]),
        position[:, None],
        np.full((len(position), 1), 1.0 / noise),
        np.cumsum([0, *(rows.stop - rows.start for _, rows in cuts)]),
        np.array([k for k, _ in cuts]),
        states[:, 0],
        states[:, 1],
        AxisData(np.concatenate(edges), np.concatenate(torques), STEP),
    )


def _on_one_axis(recordings: Sequence[Recording]) -> list[Recording]:
    """Several recordings one after the other; a single one keeps its times."""
    shifted: list[Recording] = []
    for recording in recordings:
        begin = shifted[-1].time[-1] + BETWEEN if shifted else 0.0
        shift = begin - recording.time[0] if len(recordings) > 1 else 0.0
        moved = recording.with_delayed_command(shift)
        shifted.append(moved._replace(time=recording.time + shift))
    return shifted


def _first_state(smooth: Smoothed, start: float, noise: float) -> tuple[list[float], list[float]]:
    """Position and speed at the ``start`` [s] of a segment, and their standard deviations."""
    uncertain = np.sqrt(12.0) * noise / smooth.window  # of a speed
    position, speed = (np.interp(start, smooth.time, y) for y in (smooth.position, smooth.speed))
    first = [position, speed if abs(speed) > 2.0 * uncertain else 0.0]
    return first, [2.0 * noise, 4.0 * uncertain]


def segment_length(recordings: Sequence[Recording], noise: float) -> float:
    """Length [s] in which the axis moves over enough counts, with enough segments of it."""
    whole = sum(recording.duration for recording in recordings)
    step = max(recording.interval for recording in recordings)
    length = max(LENGTH, FEWEST_SAMPLES * step)
    wanted = COUNTS * np.sqrt(12.0) * noise
    while whole / (2.0 * length) >= FEWEST and _travel(recordings, length) < wanted:
        length *= 2.0
    return max(min(length, whole / FEWEST), FEWEST_SAMPLES * step)


def _travel(recordings: Sequence[Recording], length: float) -> float:
    """Median travel [rad] within a segment."""
    travels = [np.ptp(r.measured[rows, PHI]) for r in recordings for rows in _cut(r, length)]
    return float(np.median(travels))


def _cut(recording: Recording, length: float) -> list[slice]:
    """The rows of each segment."""
    count = max(int(recording.duration / length), 1)
    edges = np.linspace(recording.time[0], recording.time[-1], count + 1)
    bounds = np.searchsorted(recording.time, edges[:-1] - 1e-9)
    rows = [slice(a, b) for a, b in zip(bounds, [*bounds[1:], len(recording.time)], strict=True)]
    return [each for each in rows if each.stop - each.start >= FEWEST_SAMPLES // 2] or rows


def _commands(recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """From when on which torque holds: before the first command none, unless it began with it."""
    time, torque = recording.command_time, recording.command
    if time[0] <= recording.time[0] + 2.0 * recording.interval:
        return time, torque
    return np.append(recording.time[0] - 1.0, time), np.append(0.0, torque)


def forced_motion(cut: Segments) -> float:
    """Root mean square [rad] of the motion within segments beyond one at constant speed."""
    left = []
    for start, end in itertools.pairwise(cut.bounds):
        t, q = cut.time[start:end], cut.measured[start:end, 0]
        basis, _ = np.linalg.qr(np.column_stack((np.ones(len(t)), t - t[0])))
        left.append(q - basis @ (basis.T @ q))
    return float(np.sqrt(np.mean(np.concatenate(left) ** 2))) or 1e-300


def _spread_over(parts: list[Cut], most: int) -> list[Cut]:
    """At most that many of the parts, evenly spread."""
    if len(parts) <= most:
        return parts
    chosen = np.linspace(0, len(parts) - 1, most).round().astype(int)
    return [parts[k] for k in chosen]
