"""Reads files of ``furuta simulate --out``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import RIGID_STATES
from furuta_recordings.readers.drive import through_drive
from furuta_recordings.recording import Recording
from furuta_sim.parameters import Actuator


def read_simulation(path: Path) -> tuple[Recording, list[str]]:
    """A recording from the series of a simulation."""
    try:
        with np.load(path) as file:
            series = {name: file[name] for name in file.files}
            time, measured, command = series["time"], series["estimate"], series["command"]
    except (KeyError, ValueError, OSError):
        raise ParameterError(f"{path} is not a file of `furuta simulate --out`") from None
    measured = np.array(measured[:, :RIGID_STATES])
    recording = Recording(path.name, time, measured, time, command)
    if "drive" in series:
        voltage_range, bits = series["drive"]
        actuator = Actuator(float(voltage_range), int(bits))
        return through_drive(recording, actuator, "the file")
    return recording, []
