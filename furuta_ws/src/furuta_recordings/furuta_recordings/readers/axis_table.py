"""Reads the recording of a single axis from a table: time, position, and what drives it."""

from pathlib import Path

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, RIGID_STATES
from furuta_recordings.readers.columns import (
    ANGLE_UNITS,
    ANGLE_WORDS,
    DRIVE_UNITS,
    LENGTH_UNITS,
    Columns,
    column,
    in_si,
)
from furuta_recordings.readers.mapping import Mapping
from furuta_recordings.readers.table import command_column
from furuta_recordings.readers.times import clock_column, seconds, with_usable_times
from furuta_recordings.recording import Recording
from furuta_recordings.table_files import read_columns

# Last words of the names of a position, and of a torque.
POSITIONS = {(word,) for word in ANGLE_WORDS}
DRIVES = {("torque",), ("force",), ("current",)}


def read_axis(
    path: Path,
    position: str | None = None,
    command: str | None = None,
    torque_constant: float = 1.0,
) -> Recording:
    """The recording of an axis: its position as arm angle [rad or m], its torque as command.

    ``position`` and ``command`` are columns, needed where their names are not usual ones.
    ``torque_constant`` is the torque or force that a command of 1 V, A or N m stands for.
    """
    columns = read_columns(path)
    clock = clock_column(path, columns, None)
    where = _position_column(path, columns, position)
    usual = (name for name in columns if column(name).words[-1:] in DRIVES)
    driven = command_column(path, columns, Mapping(command=command or next(usual, None)))
    time = seconds(path, columns, clock)
    measured = np.full((len(time), RIGID_STATES), np.nan)
    measured[:, PHI] = in_si(path, columns, where, ANGLE_UNITS | LENGTH_UNITS)
    torque = torque_constant * in_si(path, columns, driven, DRIVE_UNITS)
    elapsed = time - time[0]
    return with_usable_times(Recording(path.name, elapsed, measured, elapsed, torque))


def _position_column(path: Path, columns: Columns, wanted: str | None) -> str:
    """The column that the user named; otherwise the only one with a usual name."""
    if wanted is not None:
        matching = [n for n in columns if wanted == n or column(n).words == column(wanted).words]
    else:
        matching = [n for n in columns if column(n).words[-1:] in POSITIONS]
    if len(matching) != 1:
        raise ParameterError(
            f"{path}: name the column of the position with --position; it has {', '.join(columns)}"
        )
    return matching[0]
