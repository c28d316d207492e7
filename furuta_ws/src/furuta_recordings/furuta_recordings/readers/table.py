"""Recordings from CSV tables of any origin."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.readers.mapping import COMMANDS, Mapping, joints_of
from furuta_recordings.recording import Recording

TIMES = ("__time", "time", "timestamp", "t", "time_s")
SPEEDS = ("velocity", "speed", "dot", "vel")


def read_table(path: Path, mapping: Mapping) -> tuple[Recording, list[str]]:
    """A recording from a CSV table, a column a series."""
    columns = _columns(path)
    names = _table_joints(columns)
    if not names:
        names = [n for n in (mapping.arm, mapping.pendulum) if n in columns]
    (arm, pendulum), findings = joints_of(path, names or list(columns), mapping)
    series: list[str | None] = [
        _angle(path, columns, arm),
        _speed(columns, arm),
        _angle(path, columns, pendulum),
        _speed(columns, pendulum),
    ]
    angles = [name for name in (series[0], series[2]) if name]
    stamped = [name for name in columns if name.lower().endswith(("header/stamp", "stamp"))]
    clock = _clock(path, columns)
    states_clock = stamped[0] if stamped else clock
    rows = np.isfinite(columns[states_clock])
    for name in angles:
        rows &= np.isfinite(columns[name])
    time = columns[states_clock][rows]
    if not len(time):
        raise ParameterError(f"{path}: no row with time and both angles")
    measured = np.full((len(time), 4), np.nan)
    for channel, column in enumerate(series):
        if column:
            measured[:, channel] = columns[column][rows]
    command = _command_column(path, columns, mapping)
    given = np.isfinite(columns[command]) & np.isfinite(columns[clock])
    findings.append(f"{path.name}: command from column {command}, times from {states_clock}")
    start = time[0]
    return Recording(
        path.name, time - start, measured, columns[clock][given] - start, columns[command][given]
    ), findings


def _columns(path: Path) -> dict[str, np.ndarray]:
    """Every column as numbers (n,), NaN where a cell is empty."""
    try:
        with path.open(newline="") as file:
            sample = file.read(4096)
            file.seek(0)
            try:
                dialect: Any = csv.Sniffer().sniff(sample.splitlines()[0], ",;\t")
            except (csv.Error, IndexError):
                dialect = csv.excel
            reader = csv.reader(file, dialect)
            header = [name.strip() for name in next(reader, [])]
            rows = [row for row in reader if row]
    except (OSError, UnicodeDecodeError) as error:
        raise ParameterError(
            f"cannot read {path}: {getattr(error, 'strerror', None) or 'not a text file'}"
        ) from None
    if not header or not rows:
        raise ParameterError(f"{path}: no table in it")
    return {
        name: np.array([_cell(path, row, k) for row in rows])
        for k, name in enumerate(header)
        if name
    }


def _cell(path: Path, row: list[str], place: int) -> float:
    text = row[place].strip() if place < len(row) else ""
    try:
        return float(text) if text else float("nan")
    except ValueError:
        return float("nan")


def _table_joints(columns: Iterable[str]) -> list[str]:
    """Joint names in columns such as /joint_states/NAME/position."""
    names = []
    for column in columns:
        parts = [part for part in column.replace(".", "/").split("/") if part]
        if len(parts) > 1 and parts[-1] == "position" and parts[-2] not in names:
            names.append(parts[-2])
    return names


def _angle(path: Path, columns: dict[str, np.ndarray], joint: str) -> str:
    found = _of_joint(columns, joint, ("position", "angle", "pos"))
    if found is None and joint in columns:
        found = joint
    if found is None:
        raise ParameterError(
            f"{path}: no column with the angle of {joint}; it has {', '.join(columns)}"
        )
    return found


def _speed(columns: dict[str, np.ndarray], joint: str) -> str | None:
    return _of_joint(columns, joint, SPEEDS)


def _of_joint(columns: Iterable[str], joint: str, endings: tuple[str, ...]) -> str | None:
    for column in columns:
        for separator in ("/", ".", "_"):
            for ending in endings:
                tail = f"{joint}{separator}{ending}"
                if column == tail or column.endswith(("/" + tail, "." + tail)):
                    return column
    return None


def _clock(path: Path, columns: dict[str, np.ndarray]) -> str:
    for name in columns:
        if name.lower() in TIMES or name.lower().startswith(("time [", "time(", "t [")):
            return name
    raise ParameterError(
        f"{path}: no column with the time, one of {', '.join(TIMES)}; it has {', '.join(columns)}"
    )


def _command_column(path: Path, columns: dict[str, np.ndarray], mapping: Mapping) -> str:
    wanted = mapping.command
    if wanted:
        exact = [name for name in columns if name.strip("/") == wanted.strip("/")]
        within = [name for name in columns if wanted.strip("/") in name and "data" in name]
        found = exact or [name for name in within if not name.endswith("offset")]
    else:
        found = [
            name
            for name in columns
            if any(part in COMMANDS for part in name.replace(".", "/").split("/"))
            and not name.endswith("offset")
        ]
    if not found:
        raise ParameterError(
            f"{path}: no command {wanted or ''}".rstrip()
            + f"; name its column with --command; it has {', '.join(columns)}"
        )
    return found[0]
