"""Reads recordings from CSV tables of any origin, with one column per series."""

from pathlib import Path

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, THETA
from furuta_recordings.csv_columns import csv_columns
from furuta_recordings.readers.columns import (
    ANGLE_UNITS,
    ANGLE_WORDS,
    COMMAND_UNITS,
    SPEED_UNITS,
    SPEED_WORDS,
    Columns,
    column,
    in_si,
    joint_column,
    joint_names,
)
from furuta_recordings.readers.mapping import COMMANDS, NO_COMMAND, Mapping, joints_of
from furuta_recordings.readers.times import clock_column, seconds, stamp_column
from furuta_recordings.recording import Recording
from furuta_recordings.series_columns import COMMAND, ESTIMATED, MEASURED, TIME, TRUE

# The measured columns of an exported series in the order of a recording.
EXPORTED = tuple(MEASURED)[:4]


def read_table(path: Path, mapping: Mapping) -> Recording:
    """A recording from a CSV table; rows without time or angle belong to the command alone."""
    columns = csv_columns(path)
    if TIME in columns and mapping == Mapping() and columns.keys() & {*MEASURED, *ESTIMATED, *TRUE}:
        return _exported(path, columns)
    clock = clock_column(path, columns, mapping.time)
    (arm, pendulum), about_joints = _joints(path, columns, mapping)
    angles = [_angle(path, columns, joint) for joint in (arm, pendulum)]
    stamps = clock if mapping.time else stamp_column(columns, angles[0]) or clock
    command = None if mapping.command == NO_COMMAND else command_column(path, columns, mapping)
    series = []
    for joint, angle in zip((arm, pendulum), angles, strict=True):
        series.append(in_si(path, columns, angle, ANGLE_UNITS))
        speed = joint_column(columns, joint, SPEED_WORDS)
        series.append(in_si(path, columns, speed, SPEED_UNITS))
    recording = _recording(
        path,
        (seconds(path, columns, stamps), np.column_stack(series)),
        (seconds(path, columns, clock), in_si(path, columns, command, COMMAND_UNITS)),
    )
    recording = recording._replace(in_radians=all(column(name).unit for name in angles))
    recording = recording.noting(about_joints) if about_joints else recording
    source = f"command from column {command}" if command else "no command"
    return recording.noting(f"{source}, times from {stamps}")


def _exported(path: Path, columns: Columns) -> Recording:
    """The measured columns of an exported series; estimates and true states are no measurements."""
    if not {*EXPORTED[::2], COMMAND} <= columns.keys():
        raise ParameterError(
            f"{path} lacks {EXPORTED[0]}, {EXPORTED[2]} or {COMMAND}, which identification needs; "
            "it takes no estimates for measurements"
        )
    time = columns[TIME]
    missing = np.full(len(time), np.nan)
    measured = np.column_stack([columns.get(name, missing) for name in EXPORTED])
    recording = _recording(path, (time, measured), (time, columns[COMMAND]))
    return recording._replace(in_radians=True).noting("the measured columns of an exported series")


def _recording(
    path: Path, samples: tuple[np.ndarray, np.ndarray], commands: tuple[np.ndarray, np.ndarray]
) -> Recording:
    """The rows with time and both angles, and those with a command and its time."""
    (time, measured), (command_time, command) = samples, commands
    rows = np.isfinite(time) & np.isfinite(measured[:, PHI]) & np.isfinite(measured[:, THETA])
    given = np.isfinite(command) & np.isfinite(command_time)
    if not np.any(rows):
        raise ParameterError(f"{path}: no row with time and both angles")
    start = time[rows][0]
    return Recording(
        path.name,
        time[rows] - start,
        measured[rows],
        command_time[given] - start,
        command[given],
    )


def _joints(path: Path, columns: Columns, mapping: Mapping) -> tuple[tuple[str, str], str]:
    """Names of arm and pendulum: from columns such as NAME/position, or columns themselves."""
    given = [name for name in (mapping.arm, mapping.pendulum) if name is not None]
    names = joint_names(columns)
    for name in given:
        if name not in names and _angle_column(columns, name) is not None:
            names = [each for each in names if column(each).words != column(name).words] + [name]
    return joints_of(path, names or list(columns), mapping)


def _angle_column(columns: Columns, joint: str) -> str | None:
    named = joint_column(columns, joint, ANGLE_WORDS)
    words = column(joint).words
    return named or next((name for name in columns if column(name).words == words), None)


def _angle(path: Path, columns: Columns, joint: str) -> str:
    name = joint if joint in columns else _angle_column(columns, joint)
    if name is None:
        raise ParameterError(
            f"{path}: no column with the angle of {joint}; it has {', '.join(columns)}"
        )
    return name


def command_column(path: Path, columns: Columns, mapping: Mapping) -> str:
    """The column that the user named, exactly or in part; otherwise one with a usual name."""
    wanted = (mapping.command or "").strip("/")
    values = [name for name in columns if not name.endswith("offset")]
    if wanted:
        exact = [name for name in columns if name.strip("/") == wanted]
        same = [name for name in columns if column(name).words == column(wanted).words]
        matching = exact or same or [name for name in values if wanted in name and "data" in name]
    else:
        matching = [name for name in values if _is_usual_command(name)]
    if not matching:
        raise ParameterError(
            f"{path}: no command {mapping.command or ''}".rstrip()
            + f"; name its column with --command; it has {', '.join(columns)}"
        )
    return matching[0]


def _is_usual_command(name: str) -> bool:
    parts = name.lower().replace(".", "/").split("/")
    return any(part in COMMANDS for part in parts) or any(
        word in COMMANDS for word in column(name).words
    )
