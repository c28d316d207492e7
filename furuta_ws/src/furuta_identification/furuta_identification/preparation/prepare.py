"""Brings a recording to SI units, upright zero and the signs of (1), and reports every change."""

from __future__ import annotations

from furuta_identification.preparation.first_command import with_first_command
from furuta_identification.preparation.options import Options
from furuta_identification.preparation.orientation import oriented
from furuta_identification.preparation.units import in_radians, with_usable_speeds
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording


def prepare(recording: Recording, options: Options) -> tuple[Recording, list[str]]:
    """The recording ready for a fit, and what was found on the way."""
    scaled = recording._replace(command=options.command_scale * recording.command)
    recording, findings = cleaned(scaled)
    for step in (
        lambda each: in_radians(each, options.angles),
        with_usable_speeds,
        with_first_command,
        lambda each: oriented(each, options.zero),
    ):
        recording, found = step(recording)
        findings += found
    return recording, [f"{recording.name}: {each}" for each in findings]
