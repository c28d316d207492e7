"""Reads the recording of a single axis: time, position, and what drives it."""

from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.cleaning import FEWEST_SAMPLES, with_usable_samples
from furuta_recordings.csv_columns import Table
from furuta_recordings.readers import is_bag
from furuta_recordings.readers.assembly import recording_of
from furuta_recordings.readers.columns import (
    ANGLE_WORDS,
    AXIS_SPEED_UNITS,
    DRIVE_UNITS,
    POSITION_UNITS,
    SPEED_WORDS,
    column,
    in_si,
    joint_column,
    listed,
)
from furuta_recordings.readers.mapping import only_one
from furuta_recordings.readers.table import command_column, joint_of
from furuta_recordings.readers.times import clock_column, seconds, with_usable_times
from furuta_recordings.recording import Recording
from furuta_recordings.table_files import read_table

# Usual last words of the name of what drives an axis, besides those of a command.
DRIVES = ("torque", "force", "current")


def read_axis(
    path: str | Path,
    position: str | None = None,
    command: str | None = None,
    torque_constant: float = 1.0,
    joint: str | None = None,
) -> Recording:
    """The recording of an axis: its position as arm angle [rad or m], its torque as command.

    Args:
        path: A table or a bag.
        position: Column of the position, if its name is not a usual one.
        command: Column or topic of what drives the axis; of a bag by default the joint's effort.
        torque_constant: Torque or force that a command of 1 V, A or N m stands for.
        joint: Joint in a bag, or in a table with several; needed if there are several.

    Raises:
        ParameterError: The file cannot be read, or a name is missing or ambiguous.
    """
    path = Path(path)
    if not path.exists():
        raise ParameterError(f"no recording {path}")
    if is_bag(path):
        if position is not None:
            raise ParameterError(f"{path}: a bag has no columns; name its joint with --joint")
        from furuta_recordings.readers.bag import read_bag_axis

        recording = read_bag_axis(path, joint, command)
    else:
        recording = _table_axis(read_table(path), position, command, joint)
    recording = recording._replace(command=torque_constant * recording.command)
    fewest = min(FEWEST_SAMPLES, len(recording.time))
    return with_usable_samples(with_usable_times(recording), (PHI,), fewest)


def _table_axis(
    table: Table, position: str | None, command: str | None, joint: str | None
) -> Recording:
    clock = clock_column(table, None, "rename the column")
    where = _position_column(table, position, joint)
    driven = command_column(table, command, DRIVES)
    time, overflow = seconds(table, clock)
    own = joint_of(table, where, _speed_column(table, where), POSITION_UNITS, AXIS_SPEED_UNITS)
    torque = in_si(table, driven, DRIVE_UNITS)
    source = f"torque from column {driven}, position from {where}, times from {clock}"
    return recording_of(table.path.name, [own], time, (time, torque), (overflow, source))


def _position_column(table: Table, wanted: str | None, joint: str | None) -> str:
    """The column that the user named; otherwise the only one with a usual name."""
    columns = table.columns
    if wanted is not None:
        matching = [wanted] if wanted in columns else []
        matching = matching or [n for n in columns if column(n).words == column(wanted).words]
    elif joint is not None:
        found = joint_column(columns, joint, ANGLE_WORDS)
        matching = [found] if found else []
    else:
        usual = [n for n in columns if column(n).words[-1:] in {(word,) for word in ANGLE_WORDS}]
        matching = [n for n in usual if len(column(n).words) == 1] or usual
    if not matching:
        raise ParameterError(
            f"{table.path}: no position {wanted or joint or ''}".rstrip()
            + f"; name its column with --position; it has {listed(table)}"
        )
    return only_one(table.path, matching, "position", "--position")


def _speed_column(table: Table, position: str) -> str | None:
    """The speed that is named as the position is."""
    own = column(position).words[:-1]
    return next(
        (n for n in table.columns if column(n).words in {(*own, w) for w in SPEED_WORDS}), None
    )
