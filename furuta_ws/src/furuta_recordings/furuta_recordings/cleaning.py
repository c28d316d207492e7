"""Drops unusable samples and commands, and refuses a recording with too few of them."""

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import Recording
from furuta_ros.topic_names import JOINTS

FEWEST_SAMPLES = 100
# Part of the samples that may be before an earlier one.
LARGEST_UNORDERED_PART = 0.1
# Time [s] to the sample before from which the speed between them means something.
SHORTEST_STEP = 1e-9
# Median intervals without a sample from which a dropout is reported.
LONGEST_GAP = 10.0
# Largest command [V] of a motor of this size.
LARGEST_COMMAND = 100.0


def cleaned(recording: Recording, driven: bool = True) -> Recording:
    """The usable part of a recording; raises :class:`ParameterError` without one.

    A recording that was not ``driven`` needs no command.
    """
    recording = _with_usable_samples(recording)
    if driven:
        recording = _with_usable_commands(recording)
    _interpolate_missing_speeds(recording)
    gap = float(np.max(np.diff(recording.time)))
    if gap > LONGEST_GAP * recording.interval:
        return recording.noting(
            f"dropout of {gap:.3f} s; the median interval is {recording.interval * 1e3:.2f} ms"
        )
    return recording


def _with_usable_samples(recording: Recording) -> Recording:
    """The samples that have both angles and a time after the one before."""
    time, measured = recording.time, recording.measured
    for angle, joint in zip((PHI, THETA), JOINTS, strict=True):
        if not np.any(np.isfinite(measured[:, angle])):
            raise ParameterError(f"{recording.name}: no angle of the {joint}")
    _refuse_unordered(recording)
    usable = np.isfinite(measured[:, PHI]) & np.isfinite(measured[:, THETA]) & np.isfinite(time)
    usable[1:] &= np.diff(np.maximum.accumulate(np.nan_to_num(time, nan=-np.inf))) > SHORTEST_STEP
    if np.sum(usable) < FEWEST_SAMPLES:
        raise ParameterError(
            f"{recording.name}: {np.sum(usable)} usable samples of {len(time)}, at least "
            f"{FEWEST_SAMPLES} needed"
        )
    if not np.all(usable):
        recording = recording.noting(
            f"{np.sum(~usable)} of {len(time)} samples dropped (no angle, or time not increasing)"
        )
    return recording._replace(time=time[usable], measured=measured[usable].copy())


def _refuse_unordered(recording: Recording) -> None:
    """Raise if many samples are not in the order of their times."""
    backward = np.diff(recording.time) < 0.0
    if np.sum(backward) > LARGEST_UNORDERED_PART * len(backward):
        raise ParameterError(
            f"{recording.name}: the time decreases {np.sum(backward)} times in "
            f"{len(recording.time)} samples; sort them by time, or name the column of their time "
            "with --time"
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
    largest = float(np.max(np.abs(recording.command)))
    if largest > LARGEST_COMMAND:
        raise ParameterError(
            f"{recording.name}: commands up to {largest:g} cannot be volts; give their unit with "
            "--command-scale (0.001 for millivolts)"
        )
    return recording


def _interpolate_missing_speeds(recording: Recording) -> None:
    """Fill speeds that are missing now and then, in place; a channel without any stays NaN."""
    for speed in (PHI_DOT, THETA_DOT):
        here = np.isfinite(recording.measured[:, speed])
        if np.any(here) and not np.all(here):
            recording.measured[~here, speed] = np.interp(
                recording.time[~here], recording.time[here], recording.measured[here, speed]
            )
