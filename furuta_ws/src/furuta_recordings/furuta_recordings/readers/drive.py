"""Applies the drive's converter to a command: limits and quantises it as the drive does."""

import numpy as np

from furuta_model.parts.converter import Actuator, drive
from furuta_recordings.recording import Recording


def through_drive(
    recording: Recording, actuator: Actuator, source: str
) -> tuple[Recording, list[str]]:
    """The recording with the converted command; ``source`` says where the drive is described."""
    command = np.array([drive(float(u), actuator) for u in recording.command])
    return recording._replace(command=command), [
        f"{recording.name}: command rounded to the drive's {actuator.bits} bits of "
        f"±{actuator.voltage_range:g} V (according to {source})"
    ]
