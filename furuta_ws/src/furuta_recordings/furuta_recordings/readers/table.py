"""Reads recordings from CSV tables of any origin."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.readers.csv_columns import csv_columns
from furuta_recordings.readers.mapping import COMMANDS, Mapping, joints_of
from furuta_recordings.recording import Recording

# Usual names of columns.
TIMES = ("__time", "time", "timestamp", "t", "time_s")
ANGLES = ("position", "angle", "pos")
SPEEDS = ("velocity", "speed", "dot", "vel")

Columns = dict[str, np.ndarray]


def read_table(path: Path, mapping: Mapping) -> tuple[Recording, list[str]]:
    """A recording from a CSV table with one column per series.

    Rows without time or angle belong to the command alone.
    """
    columns = csv_columns(path)
    (arm, pendulum), notes = _joints(path, columns, mapping)
    angles = [_angle(path, columns, joint) for joint in (arm, pendulum)]
    speeds = [_column_of(columns, joint, SPEEDS) for joint in (arm, pendulum)]
    clock = _clock(path, columns)
    stamps = next((name for name in columns if name.lower().endswith("stamp")), clock)
    rows = np.all([np.isfinite(columns[name]) for name in (stamps, *angles)], axis=0)
    if not np.any(rows):
        raise ParameterError(f"{path}: no row with time and both angles")
    time = columns[stamps][rows]
    series = (angles[0], speeds[0], angles[1], speeds[1])
    missing = np.full(len(time), np.nan)
    measured = np.array([columns[name][rows] if name else missing for name in series]).T
    command = _command_column(path, columns, mapping)
    given = np.isfinite(columns[command]) & np.isfinite(columns[clock])
    notes.append(f"{path.name}: command from column {command}, times from {stamps}")
    start = time[0]
    command_time = columns[clock][given] - start
    return Recording(
        path.name,
        time - start,
        np.ascontiguousarray(measured),
        command_time,
        columns[command][given],
    ), notes


def _joints(path: Path, columns: Columns, mapping: Mapping) -> tuple[tuple[str, str], list[str]]:
    """Names of arm and pendulum: from columns such as NAME/position, or columns themselves."""
    names = _joint_names(columns)
    if not names:
        names = [name for name in (mapping.arm, mapping.pendulum) if name in columns]
    return joints_of(path, names or list(columns), mapping)


def _joint_names(columns: Columns) -> list[str]:
    """Joint names in columns such as /joint_states/NAME/position."""
    names = []
    for column in columns:
        parts = [part for part in column.replace(".", "/").split("/") if part]
        if len(parts) > 1 and parts[-1] == "position" and parts[-2] not in names:
            names.append(parts[-2])
    return names


def _angle(path: Path, columns: Columns, joint: str) -> str:
    found = _column_of(columns, joint, ANGLES)
    if found is None and joint in columns:
        found = joint
    if found is None:
        raise ParameterError(
            f"{path}: no column with the angle of {joint}; it has {', '.join(columns)}"
        )
    return found


def _column_of(columns: Columns, joint: str, endings: tuple[str, ...]) -> str | None:
    """The first column named after the joint and one of the endings."""
    tails = [f"{joint}{separator}{ending}" for separator in "/._" for ending in endings]
    for column in columns:
        for tail in tails:
            if column == tail or column.endswith(("/" + tail, "." + tail)):
                return column
    return None


def _clock(path: Path, columns: Columns) -> str:
    for name in columns:
        if name.lower() in TIMES or name.lower().startswith(("time [", "time(", "t [")):
            return name
    raise ParameterError(
        f"{path}: no column with the time, one of {', '.join(TIMES)}; it has {', '.join(columns)}"
    )


def _command_column(path: Path, columns: Columns, mapping: Mapping) -> str:
    """The column that the user named, exactly or in part; otherwise one with a usual name."""
    wanted = (mapping.command or "").strip("/")
    values = [name for name in columns if not name.endswith("offset")]
    if wanted:
        exact = [name for name in columns if name.strip("/") == wanted]
        found = exact or [name for name in values if wanted in name and "data" in name]
    else:
        found = [name for name in values if _is_usual_command(name)]
    if not found:
        raise ParameterError(
            f"{path}: no command {mapping.command or ''}".rstrip()
            + f"; name its column with --command; it has {', '.join(columns)}"
        )
    return found[0]


def _is_usual_command(column: str) -> bool:
    return any(part in COMMANDS for part in column.replace(".", "/").split("/"))
