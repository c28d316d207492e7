"""Recordings of any origin for identification: bags, CSV tables, and files of ``simulate``."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from furuta_identification.record import Recording
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA, THETA_DOT
from furuta_ros.messages import NANOSECONDS
from furuta_sim.parameters import Actuator
from furuta_sim.rig import drive

from .bag import last_part, open_bag, refuse_too_long
from .recorder import PARAMETERS_FILE

# A column of a table that holds no time of its own is filled in every row or in some.
SPARSE = 0.5
TIMES = ("__time", "time", "timestamp", "t", "time_s")
COMMANDS = ("command", "effort_control", "u", "voltage")
SPEEDS = ("velocity", "speed", "dot", "vel")


class Mapping(NamedTuple):
    """What the user says of names: joints, topic of the states, topic or column of the command."""

    arm: str | None = None
    pendulum: str | None = None
    command: str | None = None
    states: str | None = None


def read(path: Path, mapping: Mapping) -> tuple[Recording, list[str]]:
    """A recording, its angles as recorded, and in words what was taken for what."""
    if not path.exists():
        raise ParameterError(f"no recording {path}")
    if path.suffix == ".npz":
        return _read_npz(path)
    if path.is_dir() or path.suffix in (".mcap", ".db3"):
        return _read_bag(path, mapping)
    return _read_csv(path, mapping)


def _read_npz(path: Path) -> tuple[Recording, list[str]]:
    try:
        with np.load(path) as file:
            series = {name: file[name] for name in file.files}
            time, measured, command = series["time"], series["estimate"], series["command"]
    except (KeyError, ValueError, OSError):
        raise ParameterError(f"{path} is no file of `furuta simulate --out`") from None
    measured = np.array(measured[:, :RIGID_STATES])
    recording = Recording(path.name, time, measured, time, command)
    if "drive" in series:
        high, bits = series["drive"]
        return _through_drive(recording, Actuator(float(high), int(bits)), "the file")
    return recording, []


def _through_drive(
    recording: Recording, actuator: Actuator, source: str
) -> tuple[Recording, list[str]]:
    command = np.array([drive(float(u), actuator) for u in recording.command])
    return recording._replace(command=command), [
        f"{recording.name}: command as the drive's converter makes it, {actuator.bits} bits of "
        f"±{actuator.voltage_range:g} V (says {source})"
    ]


def _read_bag(path: Path, mapping: Mapping) -> tuple[Recording, list[str]]:
    joints: list[tuple[float, ...]] = []
    commands: list[tuple[float, float]] = []
    findings: list[str] = []
    with open_bag(path) as reader:
        kinds = {c.topic: c.msgtype for c in reader.connections}
        states = _states_topic(path, kinds, mapping)
        command = _command_topic(path, kinds, states, mapping)
        names: tuple[str, str] | None = None
        chosen = [c for c in reader.connections if c.topic in (states, command)]
        refuse_too_long(path, chosen)
        for connection, stamp, data in reader.messages(chosen):
            message: Any = reader.deserialize(data, connection.msgtype)
            if connection.topic == states:
                if names is None:
                    names, found = _joints(path, list(message.name), mapping)
                    findings += found
                joints.append(_joint_row(message, names, stamp / NANOSECONDS))
            else:
                commands.append((stamp / NANOSECONDS, _number(path, message)))
    if not joints:
        raise ParameterError(f"{path}: no message on {states}")
    table = np.array(joints)
    time = table[:, 1] if _usable(table[:, 1]) else table[:, 0]
    if command == "":
        commands = list(zip(time, table[:, 6], strict=True))
    u = np.array(commands) if commands else np.zeros((0, 2))
    start = time[0]
    recording = Recording(path.name, time - start, table[:, 2:6], u[:, 0] - start, u[:, 1])
    kept = path / PARAMETERS_FILE
    if kept.is_file():
        return _with_parameters(recording, kept, findings)
    return recording, findings


def _with_parameters(
    recording: Recording, file: Path, findings: list[str]
) -> tuple[Recording, list[str]]:
    try:
        plant = yaml.safe_load(file.read_text())["plant"]["ros__parameters"]
        actuator = Actuator(plant["actuator.voltage_range"], plant["actuator.bits"])
    except (yaml.YAMLError, KeyError, TypeError):
        return recording, findings
    recording, found = _through_drive(recording, actuator, "the bag")
    return recording, findings + found


def _usable(stamps: np.ndarray) -> bool:
    return bool(np.ptp(stamps) > 0.0)


def _states_topic(path: Path, kinds: dict[str, str], mapping: Mapping) -> str:
    states = [topic for topic, kind in kinds.items() if kind == "sensor_msgs/msg/JointState"]
    if mapping.states:
        wanted = [topic for topic in states if topic.strip("/") == mapping.states.strip("/")]
    else:
        wanted = [
            t for name in ("measurement", "joint_states") for t in states if last_part(t) == name
        ]
        wanted = wanted or (states if len(states) == 1 else [])
    if not wanted:
        raise ParameterError(
            f"{path}: needs a topic of type sensor_msgs/msg/JointState, given by --states; it has "
            + (", ".join(states) or f"none, only {_listed(kinds)}")
        )
    return wanted[0]


def _listed(kinds: dict[str, str]) -> str:
    return ", ".join(f"{topic} ({kind})" for topic, kind in kinds.items()) or "no topics"


def _command_topic(path: Path, kinds: dict[str, str], states: str, mapping: Mapping) -> str:
    """The command's topic; "" for the effort in the states."""
    if mapping.command == "effort":
        return ""
    if mapping.command:
        wanted = [t for t in kinds if t.strip("/") == mapping.command.strip("/")]
    else:
        wanted = [t for name in COMMANDS for t in kinds if name in last_part(t) and t != states]
    if not wanted:
        raise ParameterError(
            f"{path}: no command {mapping.command or ''}".rstrip()
            + f"; name its topic with --command (effort: that of {states}); it has {_listed(kinds)}"
        )
    return wanted[0]


def _joints(path: Any, names: list[str], mapping: Mapping) -> tuple[tuple[str, str], list[str]]:
    """The names of arm and pendulum among those there are."""
    given = (mapping.arm, mapping.pendulum)
    for name in given:
        if name is not None and name not in names:
            raise ParameterError(f"{path}: no joint {name}; it has {', '.join(names) or 'none'}")
    if given[0] and given[1]:
        return (given[0], given[1]), []
    if "arm" in names and "pendulum" in names and given == (None, None):
        return ("arm", "pendulum"), []
    rest = [name for name in names if name not in given]
    if len(names) != 2:
        raise ParameterError(
            f"{path}: say which joint is which with --arm and --pendulum; it has "
            + (", ".join(names) or "none")
        )
    arm = given[0] or rest.pop(0)
    pendulum = given[1] or rest.pop(0)
    return (arm, pendulum), [
        f"{Path(path).name}: {arm} taken for the arm, {pendulum} for the pendulum"
    ]


def _joint_row(message: Any, names: tuple[str, str], time: float) -> tuple[float, ...]:
    """Arrival, stamp, φ, φ̇, θ, θ̇ and the arm's effort; NaN for what is not there."""
    stamp = message.header.stamp
    row = [time, stamp.sec + stamp.nanosec / NANOSECONDS, *[float("nan")] * 5]
    there = list(message.name)
    for name, angle, speed in ((names[0], PHI, PHI_DOT), (names[1], THETA, THETA_DOT)):
        if name in there:
            place = there.index(name)
            row[2 + angle] = _at(message.position, place)
            row[2 + speed] = _at(message.velocity, place)
    if names[0] in there:
        row[6] = _at(message.effort, there.index(names[0]))
    return tuple(row)


def _at(series: Any, place: int) -> float:
    return float(series[place]) if place < len(series) else float("nan")


def _number(path: Path, message: Any) -> float:
    """The command in a message: its data, the first of them if there are several."""
    value = getattr(message, "data", None)
    if value is None:
        raise ParameterError(f"{path}: a command of type {message.__msgtype__} holds no number")
    if isinstance(value, (int, float)):
        return float(value)
    if not len(value):
        raise ParameterError(f"{path}: a command without a value")
    return float(value[0])


def _read_csv(path: Path, mapping: Mapping) -> tuple[Recording, list[str]]:
    columns = _columns(path)
    names = _table_joints(columns)
    if not names:
        names = [n for n in (mapping.arm, mapping.pendulum) if n in columns]
    (arm, pendulum), findings = _joints(path, names or list(columns), mapping)
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
