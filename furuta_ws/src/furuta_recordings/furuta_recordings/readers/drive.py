"""The command as the drive's converter makes it: what the rig got, not what was asked for."""

from __future__ import annotations

import numpy as np

from furuta_recordings.recording import Recording
from furuta_sim.parameters import Actuator
from furuta_sim.plant import drive


def through_drive(
    recording: Recording, actuator: Actuator, source: str
) -> tuple[Recording, list[str]]:
    """The recording with the drive's steps in its command; ``source`` knows the drive."""
    command = np.array([drive(float(u), actuator) for u in recording.command])
    return recording._replace(command=command), [
        f"{recording.name}: command as the drive's converter makes it, {actuator.bits} bits of "
        f"±{actuator.voltage_range:g} V (says {source})"
    ]
