"""Brings recordings to SI units, upright zero and the signs of (1), and reports every change."""

from typing import NamedTuple

import numpy as np

from furuta.identification.options import AUTO_DIRECTION, Options
from furuta.identification.preparation.angles import (
    AUTO,
    DEGREES,
    angle_unit,
    in_unit,
    oriented,
    with_usable_speeds,
)
from furuta.identification.regression.equations import arm_misfits
from furuta.identification.regression.speeds import speed_lag, with_speeds
from furuta.identification.regression.windows import WINDOW
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI_DOT
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording

# The arm moves above this part of its largest speed and above this speed [rad/s], for at least so
# many samples.
MOVING_PART = 0.03
SLOWEST_MOTION = 0.05
SHORTEST_MOTION = 5
# Interval [s] between commands from which they are steps; otherwise they are a stream.
STEP_INTERVAL = 0.1
# How long [s] before the first command the arm must move for a command to be missing, in a stream.
# For steps it is STEP_INTERVAL: a shorter time may be a delay.
EARLY = 0.02
# How long [s] a command is assumed to have held when a log starts in motion.
HELD_BEFORE = 1.0
# With at most so many different commands, a missing one was probably one of them.
FEW_VALUES = 10
# The first command's own value is kept unless its misfit is larger than the best by this factor.
ALMOST_AS_GOOD = 1.2
# Logarithm of the likelihood ratio from which a command is missing.
SURE = 4.6
FEWEST_SAMPLES = 100


class Prepared(NamedTuple):
    """Recordings ready for a fit, with the unit and the direction that they shared."""

    recordings: list[Recording]
    angles: str
    direction: float


def prepare(recording: Recording, options: Options, usual: float = AUTO_DIRECTION) -> Recording:
    """One recording ready for a fit or for a prediction.

    ``usual`` is the direction of other recordings' pendulum angle, if this one does not tell it.
    """
    return prepare_all([recording], options, usual).recordings[0]


def prepare_all(
    recordings: list[Recording], options: Options, usual: float = AUTO_DIRECTION
) -> Prepared:
    """The recordings of one rig. They share units; each has its own orientation."""
    scale = options.command_scale
    ready = [cleaned(r._replace(command=scale * r.command)) for r in recordings]
    angles = angle_unit(ready, options.angles)
    if angles == DEGREES:
        source = "detected" if options.angles == AUTO else "as given"
        ready = [r if r.in_radians else r.noting(f"angles in {angles} ({source})") for r in ready]
    moving = [with_first_command(with_usable_speeds(in_unit(r, angles))) for r in ready]
    rotated, direction = oriented(moving, options, usual)
    return Prepared(rotated, angles, direction)


def with_first_command(recording: Recording) -> Recording:
    """The recording with one more command if the first one is missing."""
    onset = _onset(recording)
    if onset is not None and onset <= recording.time[SHORTEST_MOTION]:
        return _started_in_motion(recording)
    first = recording.command_time[0]
    intervals = np.diff(recording.command_time)
    period = float(np.median(intervals)) if len(intervals) else np.inf
    early = STEP_INTERVAL if period > STEP_INTERVAL else EARLY
    if onset is None or onset >= first - early or recording.command[0] == 0.0:
        return recording
    start = _start(onset, first, period)
    value = _likeliest_value(recording, start)
    if value is None:
        return recording
    return _with_command(recording, start, value).noting(
        f"the first command is missing: the arm moves at {onset:.3f} s, the first command "
        f"({recording.command[0]:g} V) is at {first:.3f} s; assumed {value:g} V from {start:.3f} s "
        "on"
    )


def _start(onset: float, first: float, period: float) -> float:
    """Time of the missing command [s]: a whole number of intervals earlier, or the ``onset``."""
    if STEP_INTERVAL < period < np.inf:
        candidate = first - period * max(1, round((first - onset) / period))
        if abs(candidate - onset) < STEP_INTERVAL:
            return candidate
    return onset


def _with_command(recording: Recording, time: float, value: float) -> Recording:
    """The recording with one more command before the others."""
    return recording._replace(
        command_time=np.append(time, recording.command_time),
        command=np.append(value, recording.command),
    )


def _likeliest_value(recording: Recording, time: float) -> float | None:
    """The command at ``time`` [s] that fits the arm's equation best, one of the others [V].

    None if the arm's equation is almost as likely without it.
    """
    own = float(recording.command[0])
    others = np.unique(recording.command)
    candidates = [own, -own, *(float(u) for u in others if len(others) <= FEW_VALUES)]
    moving = with_speeds(recording, speed_lag(recording))
    logs = [moving, *(_with_command(moving, time, u) for u in candidates)]
    without, *misfits = [float(arm_misfits(log, np.zeros(1))[0]) for log in logs]
    best = int(np.argmin(misfits))
    windows = recording.duration / WINDOW
    if windows * np.log(without / misfits[best]) < SURE:
        return None
    return own if misfits[0] <= ALMOST_AS_GOOD * misfits[best] else candidates[best]


def _started_in_motion(recording: Recording) -> Recording:
    """The part with commands; the first command is assumed to have held before."""
    first = recording.command_time[0]
    rest = recording.between(first - EARLY, np.inf)
    if len(rest.time) < FEWEST_SAMPLES:
        raise ParameterError(
            f"{recording.name}: {len(rest.time)} samples after the first command, at least "
            f"{FEWEST_SAMPLES} needed"
        )
    return _with_command(rest, first - HELD_BEFORE, float(recording.command[0])).noting(
        "in motion at the start: the state there is fitted too, from the first command at "
        f"{first:.3f} s on"
    )


def _onset(recording: Recording) -> float | None:
    """When the arm starts to move [s]; None if it never moves."""
    speed = np.abs(with_speeds(recording, 0.0).measured[:, PHI_DOT])
    moving = speed > max(SLOWEST_MOTION, MOVING_PART * float(np.max(speed)))
    run = np.convolve(moving, np.ones(SHORTEST_MOTION), "valid") == SHORTEST_MOTION
    return float(recording.time[np.argmax(run)]) if np.any(run) else None
