"""Makes a recording of samples and commands that were read, whatever they were read from."""

from collections.abc import Iterable, Sequence
from math import pi
from typing import NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, RIGID_STATES, THETA
from furuta_recordings.readers.columns import ANGLE_UNITS, COUNT_UNITS
from furuta_recordings.recording import Recording
from furuta_ros.topics import JOINTS

# Part of the samples of either joint that have both, below which the joints come in turn.
TOGETHER = 0.5
# Part of the turn by which angles may exceed it, and by which a counter's size may be misjudged.
MARGIN = 0.01
# The counts of a turn are a power of two, or a multiple of this.
ROUND = 100.0
# Part of the travel from which a step may be an overflow.
LARGE = 0.5


class Joint(NamedTuple):
    """Angle and speed (n,) of a joint in SI units; by how much the angle jumped at each turn."""

    angle: np.ndarray
    speed: np.ndarray
    turn: float = 0.0

    @classmethod
    def of(cls, angle: np.ndarray, speed: np.ndarray, unit: str, size: float) -> "Joint":
        """From an angle in a ``unit`` of that ``size``, which may begin anew after each turn."""
        values, turn = continuous(angle, unit)
        return cls(size * values, speed, turn)


def recording_of(
    name: str,
    joints: Sequence[Joint],
    time: np.ndarray,
    commands: tuple[np.ndarray, np.ndarray],
    findings: Iterable[str] = (),
) -> Recording:
    """The samples with an angle of each joint, and the commands (times, values) with a time.

    Of a single joint the recording is that of the arm alone. Times begin with the first sample.
    """
    measured = np.full((len(time), RIGID_STATES), np.nan)
    told = [text for text in findings if text]
    names = JOINTS if len(joints) > 1 else ("axis",)
    for index, own, joint in zip((PHI, THETA), names, joints, strict=False):
        measured[:, index], measured[:, index + 1] = joint.angle, joint.speed
        if joint.turn:
            told.append(f"the angle of the {own} begins anew after {joint.turn:.6g}: continued")
    known = [np.isfinite(joint.angle) & np.isfinite(time) for joint in joints]
    rows = np.logical_and.reduce(known)
    if len(joints) > 1 and np.sum(rows) < TOGETHER * min(map(np.sum, known)):
        rows = _merge(measured, time, known)
        told.append("arm and pendulum come at different times: interpolated between samples")
    if not np.any(rows):
        held = [np.any(np.isfinite(joint.angle)) for joint in joints]
        empty = [own for own, holds in zip(names, held, strict=True) if not holds]
        reason = f"angle of the {empty[0]} in any row" if empty else "row with time and position"
        raise ParameterError(f"{name}: no {reason}")
    if np.sum(rows) < len(rows):
        told.append(f"{len(rows) - np.sum(rows)} of {len(rows)} rows hold no position")
    start = time[rows][0]
    command_time, command = commands
    given = np.isfinite(command) & np.isfinite(command_time)
    recording = Recording(
        name, time[rows] - start, measured[rows], command_time[given] - start, command[given]
    )._replace(start=float(start))
    for text in told:
        recording = recording.noting(text)
    return recording


def _merge(measured: np.ndarray, time: np.ndarray, known: Sequence[np.ndarray]) -> np.ndarray:
    """Interpolate the joint with more samples at those of the other, in place; the rows with both.

    The denser one loses less by it.
    """
    few, many = sorted((0, 1), key=lambda joint: int(np.sum(known[joint])))
    order = np.argsort(time[known[many]], kind="stable")
    times = time[known[many]][order]
    if not len(times):
        return known[many]
    for column in (2 * many, 2 * many + 1):
        values = measured[known[many], column][order]
        measured[known[few], column] = np.interp(time[known[few]], times, values)
    return known[few] & (time >= times[0]) & (time <= times[-1])


def continuous(values: np.ndarray, unit: str) -> tuple[np.ndarray, float]:
    """Angles or counts (n,) without jumps by a turn, and the size of that turn, or 0.

    A recording that exceeds a turn, or has no jump of half of it, is left as it is.
    """
    known = np.isfinite(values)
    steps = np.abs(np.diff(values[known]))
    if not len(steps):
        return values, 0.0
    travel = float(np.ptp(values[known]))
    if not np.max(steps) > LARGE * travel:
        return values, 0.0
    if unit in ANGLE_UNITS:
        turns = [2.0 * pi / ANGLE_UNITS[unit]]
    else:
        turns = [] if unit else [2.0 * pi, 360.0]
    turns = [turn for turn in turns if travel <= (1.0 + MARGIN) * turn]
    if not unit or unit in COUNT_UNITS:
        turns += _counters(values[known])
    turn = next((turn for turn in turns if np.max(steps) > 0.5 * turn), 0.0)
    if not turn:
        return values, 0.0
    result = values.copy()
    result[known] = np.unwrap(values[known], period=turn)
    return result, turn


def _counters(counts: np.ndarray) -> list[float]:
    """The size of the counter that these counts may come from, if they do.

    It is what the jumps show together with the steps beside them, and the counts reach its ends.
    """
    steps, low, high = np.diff(counts), np.min(counts), np.max(counts)
    if np.any(counts != np.round(counts)):
        return []
    jumps = np.abs(steps) > LARGE * (high - low)
    usual = np.where(jumps, 0.0, steps)
    beside = 0.5 * (np.append(0.0, usual[:-1]) + np.append(usual[1:], 0.0))
    shown = float(np.median(np.abs(steps - beside)[jumps]))
    power, multiple = 2.0 ** round(np.log2(shown)), ROUND * round(shown / ROUND)
    size = power if abs(shown - power) <= MARGIN * power else multiple
    start = 0.0 if low >= 0.0 else -0.5 * size
    slack = 1.0 + 2.0 * float(np.max(np.abs(usual)))
    inside = start <= low and high < start + size and high - low >= size - slack
    return [size] if inside and abs(shown - size) <= max(MARGIN * power, 0.25 * ROUND) else []
