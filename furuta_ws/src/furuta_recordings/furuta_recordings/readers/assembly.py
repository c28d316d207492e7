"""Makes a recording of samples and commands that were read, whatever they were read from."""

from collections.abc import Iterable, Sequence
from math import pi
from typing import NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, RIGID_STATES, THETA
from furuta_recordings.cleaning import LARGEST_UNORDERED_PART
from furuta_recordings.readers.columns import ANGLE_UNITS, COUNT_UNITS
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import PAUSE
from furuta_ros.topics import JOINTS

# Part of the samples of either joint that have both, below which the joints come in turn.
TOGETHER = 0.5
# Part of the turn by which angles may exceed it, and by which a counter's size may be misjudged.
MARGIN = 0.01
# The counts of a turn are a power of two, or a multiple of this.
ROUND = 100.0
# Part of the travel from which a step may be an overflow.
LARGE = 0.5
# Time [s] between two runs of one file.
RUNS_APART = 2.0 * PAUSE


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
    command_time, command = commands
    time, command_time, runs = _one_after_the_other(name, time, command_time)
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
    if len(begins := np.flatnonzero(np.diff(runs[rows])) + 1):
        told.append(f"the time begins anew: {len(begins) + 1} runs, taken one after the other")
    start = time[rows][0]
    given = np.flatnonzero(np.isfinite(command) & np.isfinite(command_time))
    given = given[np.argsort(command_time[given], kind="stable")]
    time = time[rows] - start
    recording = Recording(
        name, time, measured[rows], command_time[given] - start, command[given]
    )._replace(start=float(start), begins=tuple(time[begins].tolist()))
    for text in told:
        recording = recording.noting(text)
    return recording


def _one_after_the_other(
    name: str, time: np.ndarray, command_time: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times of samples and commands, and the number of the run of each sample (n,).

    A run whose clock begins anew follows the one before. Samples and commands are in the order of
    the log, so both begin anew equally often. Times that are in disorder stay as they are.
    """
    runs, driven = _run_numbers(time), _run_numbers(command_time)
    again, also = (int(np.max(numbers, initial=0)) for numbers in (runs, driven))
    if again > LARGEST_UNORDERED_PART * len(time):
        return time, command_time, np.zeros(len(time), int)
    if np.any(np.isfinite(command_time)) and again != also:
        raise ParameterError(
            f"{name}: the time of the samples begins anew {again} times, that of the commands "
            f"{also} times; split the file into its runs"
        )
    time, command_time, end = time.copy(), command_time.copy(), -np.inf
    for run in range(again + 1 if again else 0):
        own, with_own = runs == run, driven == run
        begin = float(np.nanmin(time[own]))
        shift = end + RUNS_APART - begin if run else 0.0
        time[own] += shift
        begin, end = begin + shift, float(np.nanmax(time[own]))
        # A command before the first sample acts from that on, one after the last on no sample.
        command_time[with_own] = np.clip(
            command_time[with_own] + shift, begin if run else None, end + 0.5 * RUNS_APART
        )
    return time, command_time, runs


def one_after_the_other(recordings: Sequence[Recording]) -> Recording:
    """Several recordings of one joint as the runs of one, in the first one's order."""
    whole = recordings[0]
    for each in recordings[1:]:
        end = max(float(whole.time[-1]), float(np.max(whole.command_time, initial=0.0)))
        shift = end + RUNS_APART - float(each.time[0])
        whole = whole._replace(
            time=np.append(whole.time, each.time + shift),
            measured=np.vstack([whole.measured, each.measured]),
            command_time=np.append(whole.command_time, each.command_time + shift),
            command=np.append(whole.command, each.command),
            findings=(*whole.findings, *each.findings),
            begins=(*whole.begins, float(each.time[0] + shift)),
        )
    return whole


def _run_numbers(time: np.ndarray) -> np.ndarray:
    """How often the time has begun anew before each row (n,).

    Steps back within :data:`PAUSE` are those of messages that overtook each other.
    """
    known = np.isfinite(time)
    numbers = np.zeros(len(time), int)
    numbers[known] = np.cumsum(np.diff(time[known], prepend=time[known][:1]) < -PAUSE)
    return np.maximum.accumulate(numbers)


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
