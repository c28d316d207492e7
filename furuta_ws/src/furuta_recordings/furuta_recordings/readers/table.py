"""Reads recordings from tables of any origin, with one column per series."""

import re
from collections.abc import Collection, Iterable
from collections.abc import Mapping as Units
from pathlib import Path
from zipfile import ZipFile, is_zipfile

import numpy as np

from furuta_model.parameters import ParameterError, build
from furuta_model.sensors import Actuator
from furuta_model.state import RIGID_STATES
from furuta_recordings.csv_columns import Table
from furuta_recordings.readers.assembly import Joint, recording_of
from furuta_recordings.readers.columns import (
    ANGLE_UNITS,
    ANGLE_WORDS,
    AXIS_SPEED_UNITS,
    AXIS_UNITS,
    COMMAND_UNITS,
    DRIVE_UNITS,
    DRIVE_WORDS,
    POSITION_UNITS,
    SPEED_UNITS,
    SPEED_WORDS,
    column,
    in_si,
    joint_column,
    joint_names,
    listed,
    unit_of,
    values_of,
)
from furuta_recordings.readers.mapping import (
    COMMANDS,
    NO_COMMAND,
    Mapping,
    joints_of,
    only_one,
    split_names,
)
from furuta_recordings.readers.times import clock_column, seconds, stamp_column
from furuta_recordings.recording import Recording
from furuta_recordings.series_columns import ANGLES, COMMAND, MEASURED, TIME
from furuta_recordings.table_files import read_columns
from furuta_recordings.table_files import read_table as table_of

# The measured angles of an exported series.
ARM, PENDULUM = list(MEASURED)[0:4:2]
# Usual last words of the name of what drives an axis, besides those of a command.
DRIVES = ("torque", "force", "current")
# Last words of the name of what drives a joint.
OF_JOINT = ("effort", *DRIVES)


def read_table(path: Path, mapping: Mapping) -> Recording:
    """A recording from a table; rows without time or angle belong to the command alone."""
    table = table_of(path, split_names(mapping.columns), mapping.rate)
    columns = table.columns
    if TIME in columns and mapping == Mapping() and columns.keys() & ANGLES:
        mapping = _exported(table)
    clock = clock_column(table, mapping.time)
    names, about_joints = _joints(table, mapping, clock)
    angles = [_angle(table, name) for name in names]
    stamps = clock if mapping.time else stamp_column(table, angles[0]) or clock
    command = None if mapping.command == NO_COMMAND else _command_column(table, mapping.command)
    alone = _speed_column(table, angles[0]) if len(angles) == 1 else None
    speeds = [joint_column(columns, name, SPEED_WORDS) or alone for name in names]
    joints = [
        _joint_of(table, angle, speed, ANGLE_UNITS, SPEED_UNITS)
        for angle, speed in zip(angles, speeds, strict=True)
    ]
    if len(joints) == 1:
        rest = np.zeros(len(joints[0].angle))
        joints.insert(0, Joint(rest, np.full(len(rest), np.nan)))
    time, overflow = seconds(table, stamps)
    command_time, _ = seconds(table, clock)
    source = f"command from column {command}" if command else "no command"
    recording = recording_of(
        path.name,
        joints,
        time,
        (command_time, in_si(table, command, COMMAND_UNITS)),
        (overflow, about_joints, f"{source}, times from {stamps}"),
    )
    return recording._replace(in_radians=all(unit_of(table, name) for name in angles))


def _joint_of(
    table: Table, angle: str, speed: str | None, units: Units, speed_units: Units
) -> Joint:
    """A joint from the columns of its angle and of its speed."""
    unit = unit_of(table, angle)
    in_si(table, angle, units)  # raises an error for a unit of something else
    values = values_of(table, angle)
    return Joint.of(values, in_si(table, speed, speed_units), unit, units.get(unit, 1.0))


def _exported(table: Table) -> Mapping:
    """The measured columns of an exported series; estimates and true states are no measurements."""
    if not {ARM, PENDULUM, COMMAND} <= table.columns.keys():
        raise ParameterError(
            f"{table.path} lacks {ARM}, {PENDULUM} or {COMMAND}, which identification needs; "
            "it takes no estimates for measurements"
        )
    return Mapping(ARM, PENDULUM, COMMAND, time=TIME)


def _joints(table: Table, mapping: Mapping, clock: str) -> tuple[tuple[str, ...], str]:
    """Names of arm and pendulum: from columns such as NAME/position, or columns themselves.

    Of a pendulum that swings freely its own is enough.
    """
    given = [name for name in (mapping.arm, mapping.pendulum) if name is not None]
    names = joint_names(table.columns)
    for name in given:
        if name not in names and _angle_column(table.columns, name) is not None:
            names = [each for each in names if column(each).words != column(name).words] + [name]
    others = (*SPEED_WORDS, *DRIVE_WORDS, *COMMANDS)
    names = names or [
        name for name in table.columns if name != clock and column(name).words[-1:][0] not in others
    ]
    if mapping.command == NO_COMMAND and mapping.arm is None and len(names) == 1:
        return (mapping.pendulum or names[0],), "no angle of the arm: taken to be at rest"
    return joints_of(table.path, names, mapping)


def _angle_column(columns: Iterable[str], joint: str) -> str | None:
    named = joint_column(columns, joint, ANGLE_WORDS)
    words = column(joint).words
    return named or next((name for name in columns if column(name).words == words), None)


def _angle(table: Table, joint: str) -> str:
    name = joint if joint in table.columns else _angle_column(table.columns, joint)
    if name is None:
        raise ParameterError(
            f"{table.path}: no column with the angle of {joint}; it has {listed(table)}"
        )
    return name


def _command_column(table: Table, wanted: str | None, others: Collection[str] = ()) -> str:
    """The column that the user named, exactly or in part; otherwise the one with a usual name.

    A column whose whole name is usual counts more than others. ``others`` are usual names too.
    """
    wanted = (wanted or "").strip("/")
    values = [name for name in table.columns if _may_be_command(name)]
    usual = {*COMMANDS, *others}
    if wanted:
        exact = [name for name in table.columns if name.strip("/") == wanted]
        same = [name for name in table.columns if column(name).words == column(wanted).words]
        within = [name for name in values if wanted in name and "data" in name]
        matching = exact[:1] or same or within[:1]
    else:
        whole = [name for name in values if column(name).words in {(word,) for word in usual}]
        matching = whole or _first_elements([n for n in values if _is_usual_command(n, usual)])
    if not matching:
        raise ParameterError(
            f"{table.path}: no command {wanted}".rstrip()
            + f"; name its column with --command; it has {listed(table)}"
        )
    return only_one(table.path, matching, "command", "--command")


def _may_be_command(name: str) -> bool:
    """Whether a column may hold a command, not its time or how its array is arranged."""
    ends = ("offset", "stamp", "sec", "nanosec", "frame_id", "seq", "size", "stride", "label")
    return not name.lower().endswith(ends)


def _is_usual_command(name: str, usual: Collection[str]) -> bool:
    parts = name.lower().replace(".", "/").split("/")
    words = column(name).words
    return any(part in COMMANDS for part in parts) or any(word in usual for word in words)


def _first_elements(names: list[str]) -> list[str]:
    """The names, of the elements data[0], data[1] of an array only the first."""
    firsts = {re.sub(r"[\[./]\d+\]?$", "", name): name for name in reversed(names)}
    return [name for name in names if name in firsts.values()]


def read_axis_table(
    path: Path, position: str | None, joint: str | None, mapping: Mapping
) -> Recording:
    """The recording of an axis as that of an arm alone, in the units of its columns."""
    table, command = table_of(path, split_names(mapping.columns), mapping.rate), mapping.command
    where = _position_column(table, position, joint)
    clock = clock_column(table, mapping.time, beside=where)
    if command == NO_COMMAND:
        driven = None
    else:
        own_drive = joint_column(table.columns, joint, OF_JOINT) if joint and not command else None
        driven = own_drive or _command_column(table, command, DRIVES)
    time, overflow = seconds(table, clock)
    own = _joint_of(table, where, _speed_column(table, where), POSITION_UNITS, AXIS_SPEED_UNITS)
    torque = in_si(table, driven, DRIVE_UNITS)
    source = f"position from {where}, times from {clock}"
    source = f"torque from column {driven}, {source}" if driven else source
    units = unit_of(table, where), unit_of(table, driven) if driven else ""
    moved = AXIS_UNITS.get(units[0], "rad")
    named = moved, AXIS_UNITS.get(units[1], "N" if moved == "m" else "N m")
    columns = zip((where, driven), units, named, strict=True)
    guessed = [
        f"column {name} names no unit: taken as {own}"
        for name, unit, own in columns
        if name and not unit
    ]
    findings = (overflow, source, *guessed)
    recording = recording_of(table.path.name, [own], time, (time, torque), findings)
    recorded = units[0] or moved, POSITION_UNITS.get(units[0], 1.0)
    return recording._replace(units=named, position_unit=recorded)


def _position_column(table: Table, wanted: str | None, joint: str | None) -> str:
    """The column that the user named; otherwise the only one with a usual name."""
    columns = table.columns
    if wanted is not None:
        matching = [wanted] if wanted in columns else []
        matching = matching or [n for n in columns if column(n).words == column(wanted).words]
        if not matching and (elements := [n for n in columns if n.startswith(f"{wanted}[")]):
            raise ParameterError(
                f"{table.path}: {wanted} holds lists of {len(elements)}; name an element, such as "
                f"{elements[0]}"
            )
    elif joint is not None:
        found = joint_column(columns, joint, ANGLE_WORDS)
        matching = [found] if found else [name for name in columns if name == joint]
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
