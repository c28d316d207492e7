"""Reads files of ``furuta simulate --out FILE.npz``."""

from pathlib import Path
from zipfile import ZipFile, is_zipfile

import numpy as np

from furuta_model.converter import Actuator
from furuta_model.parameters import ParameterError, build
from furuta_model.state import RIGID_STATES
from furuta_recordings.recording import Recording
from furuta_recordings.table_files import read_columns


def is_simulation(path: Path) -> bool:
    """Whether a file has states of a simulation rather than columns."""
    if path.suffix.lower() != ".npz" or not is_zipfile(path):
        return False
    with ZipFile(path) as file:
        return not {"measurement.npy", "estimate.npy"}.isdisjoint(file.namelist())


def read_simulation(path: Path) -> Recording:
    """A recording from the series of a simulation."""
    series = read_columns(path)
    if not {"time", "measurement", "command"} <= series.keys():
        raise ParameterError(
            f"{path} has no time, measurement or command of `furuta simulate --out`, which "
            "identification needs; simulate again"
        )
    time, measured, command = (series[name] for name in ("time", "measurement", "command"))
    n = time.size
    shape = measured.shape[:1], measured.ndim, measured.shape[1:] >= (RIGID_STATES,)
    if time.shape != (n,) or command.shape != (n,) or shape != ((n,), 2, True):
        raise ParameterError(f"{path}: its series have different lengths")
    recording = Recording(path.name, time, np.array(measured[:, :RIGID_STATES]), time, command)
    if "drive" not in series:
        return recording
    drive = series["drive"]
    if drive.shape != (2,) or not np.all(np.isfinite(drive)):
        raise ParameterError(f"{path}: drive must be a voltage range and a number of bits")
    given = {"voltage_range": float(drive[0]), "bits": int(drive[1])}
    return recording.through_drive(build(Actuator, given), "the file")
