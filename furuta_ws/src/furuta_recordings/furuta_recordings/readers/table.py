"""Reads recordings from CSV tables of any origin."""

from collections.abc import Mapping as Dictionary
from pathlib import Path

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.csv_columns import csv_columns
from furuta_recordings.readers.column_names import (
    ANGLE_UNITS,
    COMMAND_UNITS,
    SPEED_UNITS,
    Column,
    column,
)
from furuta_recordings.readers.mapping import COMMANDS, NO_COMMAND, Mapping, joints_of
from furuta_recordings.readers.table_joints import (
    ANGLE_WORDS,
    SPEED_WORDS,
    joint_column,
    joint_names,
    words_of,
)
from furuta_recordings.readers.table_times import clock_column, seconds, stamp_column
from furuta_recordings.recording import Recording
from furuta_recordings.series_columns import COMMAND, ESTIMATED, MEASURED, TIME, TRUE

# The measured columns of an exported series in the order of a recording.
EXPORTED = tuple(MEASURED)[:4]

Columns = dict[str, np.ndarray]


def read_table(path: Path, mapping: Mapping) -> tuple[Recording, list[str]]:
    """A recording from a CSV table with one column per series.

    Rows without time or angle belong to the command alone.
    """
    columns = csv_columns(path)
    if TIME in columns and mapping == Mapping() and columns.keys() & {*MEASURED, *ESTIMATED, *TRUE}:
        return _exported(path, columns)
    clock = clock_column(path, columns, mapping.time)
    (arm, pendulum), notes = _joints(path, columns, mapping)
    angles = [_angle(path, columns, joint) for joint in (arm, pendulum)]
    speeds = [joint_column(columns, joint, SPEED_WORDS) for joint in (arm, pendulum)]
    stamps = clock if mapping.time else stamp_column(columns, angles[0]) or clock
    time, command_time = seconds(path, columns, stamps), seconds(path, columns, clock)
    rows = np.isfinite(time) & np.all([np.isfinite(columns[name]) for name in angles], axis=0)
    if not np.any(rows):
        raise ParameterError(f"{path}: no row with time and both angles")
    series = [_in_si(path, columns, name, ANGLE_UNITS)[rows] for name in angles]
    rates = [_in_si(path, columns, name, SPEED_UNITS)[rows] for name in speeds]
    command = None if mapping.command == NO_COMMAND else _command_column(path, columns, mapping)
    volts = _in_si(path, columns, command, COMMAND_UNITS)
    given = np.isfinite(volts) & np.isfinite(command_time)
    source = f"command from column {command}" if command else "no command"
    notes.append(f"{path.name}: {source}, times from {stamps}")
    start = time[rows][0]
    return Recording(
        path.name,
        time[rows] - start,
        np.ascontiguousarray(np.array([series[0], rates[0], series[1], rates[1]]).T),
        command_time[given] - start,
        volts[given],
        in_radians=all(column(name).unit for name in angles),
    ), notes


def _exported(path: Path, columns: Columns) -> tuple[Recording, list[str]]:
    """The measured columns of an exported series; estimates and true states are no measurements."""
    if not {*EXPORTED[::2], COMMAND} <= columns.keys():
        raise ParameterError(
            f"{path} lacks {EXPORTED[0]}, {EXPORTED[2]} or {COMMAND}, which identification needs; "
            "it takes no estimates for measurements"
        )
    time, command = columns[TIME], columns[COMMAND]
    missing = np.full(len(time), np.nan)
    measured = np.column_stack([columns.get(name, missing) for name in EXPORTED])
    rows, given = np.isfinite(time + measured[:, 0] + measured[:, 2]), np.isfinite(time + command)
    if not np.any(rows):
        raise ParameterError(f"{path}: no row with time and both angles")
    start = time[rows][0]
    return Recording(
        path.name,
        time[rows] - start,
        np.ascontiguousarray(measured[rows]),
        time[given] - start,
        command[given],
        in_radians=True,
    ), [f"{path.name}: the measured columns of an exported series"]


def _in_si(
    path: Path, columns: Columns, name: str | None, units: Dictionary[str, float]
) -> np.ndarray:
    """A column in SI units, if its name tells the unit; NaN for a column that is missing."""
    if name is None:
        return np.full(len(next(iter(columns.values()))), np.nan)
    unit = column(name).unit
    if unit and unit not in units:
        raise ParameterError(
            f"{path}: the unit of column {name} is not one of {', '.join(units)}; rename the column"
        )
    return columns[name] * units.get(unit, 1.0)


def _joints(path: Path, columns: Columns, mapping: Mapping) -> tuple[tuple[str, str], list[str]]:
    """Names of arm and pendulum: from columns such as NAME/position, or columns themselves."""
    given = [name for name in (mapping.arm, mapping.pendulum) if name is not None]
    names = joint_names(columns)
    for name in given:
        if name not in names and _angle_column(columns, name) is not None:
            names = [each for each in names if words_of(each) != words_of(name)] + [name]
    return joints_of(path, names or list(columns), mapping)


def _angle_column(columns: Columns, joint: str) -> str | None:
    whole = Column(words_of(joint), "").words
    found = joint_column(columns, joint, ANGLE_WORDS)
    return found or next((name for name in columns if column(name).words == whole), None)


def _angle(path: Path, columns: Columns, joint: str) -> str:
    found = joint if joint in columns else _angle_column(columns, joint)
    if found is None:
        raise ParameterError(
            f"{path}: no column with the angle of {joint}; it has {', '.join(columns)}"
        )
    return found


def _command_column(path: Path, columns: Columns, mapping: Mapping) -> str:
    """The column that the user named, exactly or in part; otherwise one with a usual name."""
    wanted = (mapping.command or "").strip("/")
    values = [name for name in columns if not name.endswith("offset")]
    if wanted:
        exact = [name for name in columns if name.strip("/") == wanted]
        same = [name for name in columns if column(name).words == words_of(wanted)]
        found = exact or same or [name for name in values if wanted in name and "data" in name]
    else:
        found = [name for name in values if _is_usual_command(name)]
    if not found:
        raise ParameterError(
            f"{path}: no command {mapping.command or ''}".rstrip()
            + f"; name its column with --command; it has {', '.join(columns)}"
        )
    return found[0]


def _is_usual_command(name: str) -> bool:
    parts = name.lower().replace(".", "/").split("/")
    return any(part in COMMANDS for part in parts) or any(
        word in COMMANDS for word in column(name).words
    )
