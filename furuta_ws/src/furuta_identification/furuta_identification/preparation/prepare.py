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
        findings += [f"{recording.name}: {remark}" for remark in remarks]
    angles, remarks = angle_unit(ready, options.angles)
    findings += remarks
    moving = []
    for recording in ready:
        usable, remarks = with_usable_speeds(in_unit(recording, angles))
        usable, about_command = with_first_command(usable)
        moving.append(usable)
        findings += [f"{recording.name}: {remark}" for remark in remarks + about_command]
    turned, direction, remarks = oriented(moving, options, usual)
    return Prepared(turned, angles, direction, [*findings, *remarks])
