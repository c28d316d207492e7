"""Brings recordings to SI units, upright zero and the signs of (1), and reports every change."""

from typing import NamedTuple

from furuta_identification.options import AUTO_DIRECTION, Options
from furuta_identification.preparation.angles import (
    angle_unit,
    in_unit,
    oriented,
    with_usable_speeds,
)
from furuta_identification.preparation.first_command import with_first_command
from furuta_model.parameters import ParameterError
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording


class Prepared(NamedTuple):
    """Recordings ready for a fit, the unit and the direction that they shared, and findings."""

    recordings: list[Recording]
    angles: str
    direction: float
    findings: list[str]


def prepare(
    recording: Recording, options: Options, usual: float = AUTO_DIRECTION
) -> tuple[Recording, list[str]]:
    """One recording ready for a fit or for a prediction, and what was found on the way.

    ``usual`` is the direction of other recordings' pendulum angle, if this one does not tell it.
    """
    ready = prepare_all([recording], options, usual)
    return ready.recordings[0], ready.findings


def prepare_all(
    recordings: list[Recording], options: Options, usual: float = AUTO_DIRECTION
) -> Prepared:
    """The recordings of one rig. They share units; each has its own orientation."""
    ready, findings = [], []
    for recording in recordings:
        usable, remarks = cleaned(
            recording._replace(command=options.command_scale * recording.command)
        )
        ready.append(usable)
        findings += named(recording, remarks)
    angles, remarks = angle_unit(ready, options.angles)
    findings += remarks
    moving = []
    for recording in ready:
        usable, about_speeds = with_usable_speeds(in_unit(recording, angles))
        usable, about_command = with_first_command(usable)
        moving.append(usable)
        findings += named(recording, [*about_speeds, *about_command])
    turned, direction, remarks = _oriented(moving, options, usual)
    return Prepared(turned, angles, direction, [*findings, *remarks])


def named(recording: Recording, remarks: list[str]) -> list[str]:
    """Remarks with the name of their recording."""
    return [f"{recording.name}: {remark}" for remark in remarks]


def _oriented(
    recordings: list[Recording], options: Options, usual: float
) -> tuple[list[Recording], float, list[str]]:
    """Every recording with θ = 0 upright; those that do not tell their direction come last.

    Also returns the last direction and what was found.
    """
    turned: dict[int, Recording] = {}
    findings: list[str] = []
    for last_try in (False, True):
        for number, recording in enumerate(recordings):
            if number in turned:
                continue
            try:
                turned[number], usual, remarks = oriented(
                    recording, options.zero, options.direction, usual
                )
            except ParameterError:
                if last_try or len(recordings) == 1:
                    raise
                continue
            findings += named(recording, remarks)
    return [turned[k] for k in range(len(recordings))], usual, findings
