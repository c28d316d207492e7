"""Recordings from bags of any origin."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.bags.bag import Bag, last_part, refuse_too_long
from furuta_recordings.readers.drive import through_drive
from furuta_recordings.readers.mapping import COMMANDS, Mapping, joints_of
from furuta_recordings.recorder_node import PARAMETERS_FILE
from furuta_recordings.recording import Recording
from furuta_ros.messages import NANOSECONDS, stamp_nanoseconds
from furuta_sim.parameters import Actuator


def read_bag(path: Path, mapping: Mapping) -> tuple[Recording, list[str]]:
    """A recording from a bag of joint states and a command."""
    joints: list[tuple[float, ...]] = []
    commands: list[tuple[float, float]] = []
    findings: list[str] = []
    with Bag(path) as reader:
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
                    names, found = joints_of(path, list(message.name), mapping)
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
    recording, found = through_drive(recording, actuator, "the bag")
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


def _joint_row(message: Any, names: tuple[str, str], time: float) -> tuple[float, ...]:
    """Arrival, stamp, φ, φ̇, θ, θ̇ and the arm's effort; NaN for what is not there."""
    row = [time, stamp_nanoseconds(message) / NANOSECONDS, *[float("nan")] * 5]
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
