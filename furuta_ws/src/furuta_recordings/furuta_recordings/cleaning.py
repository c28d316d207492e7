"""Drops unusable samples and commands, and refuses a recording with too few of them."""

from collections.abc import Sequence

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import PAUSE
from furuta_ros.topics import JOINTS

FEWEST_SAMPLES = 100
# Part of the samples that may be before an earlier one.
LARGEST_UNORDERED_PART = 0.1
# Time [s] to the sample before from which the speed between them means something.
SHORTEST_STEP = 1e-9
# Median intervals without a sample from which a dropout is reported.
LONGEST_GAP = 10.0
# Largest command [V] of a motor of this size.
LARGEST_COMMAND = 100.0


def cleaned(
    recording: Recording, driven: bool = True, joints: Sequence[int] = (PHI, THETA)
) -> Recording:
    """The usable part of a recording; raises :class:`ParameterError` without one.

    A recording that was not ``driven`` needs no command. ``joints`` are the angles that it needs;
    the command of an arm alone may be in any unit.
    """
    recording = with_usable_samples(recording, joints)
    if driven:
        recording = _with_usable_commands(recording)
    if driven and THETA in joints:
        _refuse_other_units(recording)
    _interpolate_missing_speeds(recording)
    within_runs = ~np.isin(recording.time[1:], recording.begins)
    gap = float(np.max(np.diff(recording.time)[within_runs], initial=0.0))
    if gap > LONGEST_GAP * recording.interval:
        return recording.noting(
            f"dropout of {gap:.3f} s; the median interval is {recording.interval * 1e3:.2f} ms"
        )
    return recording


def with_usable_samples(
    recording: Recording, joints: Sequence[int] = (PHI, THETA), fewest: int = FEWEST_SAMPLES
) -> Recording:
    """The samples that have the angles of these joints and a time after the one before."""
    time, measured = recording.time, recording.measured
    for angle in joints:
        if not np.any(np.isfinite(measured[:, angle])):
            name = JOINTS[angle // 2]
            raise ParameterError(f"{recording.name}: no angle of the {name}")
    _refuse_unordered(recording)
    has_angles = np.all(np.isfinite(measured[:, list(joints)]), axis=1) & np.isfinite(time)
    later = np.ones(len(time), bool)
    later[1:] = np.diff(np.maximum.accumulate(np.nan_to_num(time, nan=-np.inf))) > SHORTEST_STEP
    usable = has_angles & later
    counts = f"{np.sum(~has_angles)} without an angle, {np.sum(has_angles & ~later)} not later"
    if np.sum(usable) < fewest:
        raise ParameterError(
            f"{recording.name}: {np.sum(usable)} usable samples of {len(time)}, at least "
            f"{fewest} needed; {counts} than the one before"
        )
    if not np.all(usable):
        recording = recording.noting(
            f"{np.sum(~usable)} of {len(time)} samples dropped: {counts} than the one before"
        )
    return recording._replace(time=time[usable], measured=measured[usable].copy())


def _refuse_unordered(recording: Recording) -> None:
    """Raise if many samples are not in the order of their times, or one is far from it."""
    steps = np.diff(recording.time)
    backward = steps < 0.0
    if np.sum(backward) > LARGEST_UNORDERED_PART * len(backward) or np.any(steps < -PAUSE):
        raise ParameterError(
            f"{recording.name}: the time decreases {np.sum(backward)} times in "
            f"{len(recording.time)} samples; sort them by time, name another column of the time, "
            "or give each run as a recording of its own"
        )


def _with_usable_commands(recording: Recording) -> Recording:
    given = np.isfinite(recording.command) & np.isfinite(recording.command_time)
    recording = recording._replace(
        command=recording.command[given], command_time=recording.command_time[given]
    )
    if not np.any(given):
        raise ParameterError(
            f"{recording.name}: no command in it; name its topic or column with --command"
        )
    return recording


def _refuse_other_units(recording: Recording) -> None:
    """Raise if commands are too large for volts."""
    largest = float(np.max(np.abs(recording.command)))
    if largest > LARGEST_COMMAND:
        raise ParameterError(
            f"{recording.name}: commands up to {largest:g} cannot be volts; give their unit with "
            "--command-scale (0.001 for millivolts)"
        )


def _interpolate_missing_speeds(recording: Recording) -> None:
    """Fill speeds that are missing now and then, in place; a channel without any stays NaN."""
    for speed in (PHI_DOT, THETA_DOT):
        here = np.isfinite(recording.measured[:, speed])
        if np.any(here) and not np.all(here):
            recording.measured[~here, speed] = np.interp(
                recording.time[~here], recording.time[here], recording.measured[here, speed]
            )
