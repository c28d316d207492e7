"""Reads recordings from bags of any origin: joint states and a command."""

from math import nan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from furuta_model.converter import Actuator
from furuta_model.parameters import ParameterError, build
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.bags.bag import Bag, last_part
from furuta_recordings.bags.bag_files import parameter_file_of
from furuta_recordings.bags.recorded_loop import JOINT_STATE_TYPE
from furuta_recordings.readers.mapping import COMMANDS, NO_COMMAND, Mapping, joints_of
from furuta_recordings.recording import Recording
from furuta_ros.parameter_files import read_sections
from furuta_ros.time_stamps import NANOSECONDS, stamp_nanoseconds
from furuta_ros.topic_names import JOINT_STATES, MEASUREMENT, PARAMETER_EVENTS, ROSOUT


def read_bag(path: Path, mapping: Mapping) -> Recording:
    """A recording from a bag of joint states and a command."""
    with Bag(path) as bag:
        types = {c.topic: c.msgtype for c in bag.connections}
        states = _states_topic(path, types, mapping)
        driven = mapping.command != NO_COMMAND
        command = _command_topic(path, types, states, mapping) if driven else None
        content = _Content(path, mapping, last_part(states) == MEASUREMENT)
        chosen = [c for c in bag.connections if c.topic in (states, command)]
        for connection, time, data in bag.messages_in_memory(chosen):
            message = bag.deserialize(data, connection.msgtype)
            content.add(connection.topic == states, time / NANOSECONDS, message)
    if not content.samples:
        raise ParameterError(f"{path}: no message on {states}")
    recording = content.recording(command_is_effort=driven and command is None)
    return _with_recorded_drive(recording, path)


def _states_topic(path: Path, types: dict[str, str], mapping: Mapping) -> str:
    """The topic of the joint states among the topics ``types`` (topic: type)."""
    states = [topic for topic, type_name in types.items() if type_name == JOINT_STATE_TYPE]
    if mapping.states:
        matching = [topic for topic in states if topic.strip("/") == mapping.states.strip("/")]
    else:
        usual = (MEASUREMENT, JOINT_STATES)
        matching = [topic for name in usual for topic in states if last_part(topic) == name]
        matching = matching or (states if len(states) == 1 else [])
    if not matching:
        raise ParameterError(
            f"{path}: needs a topic of type {JOINT_STATE_TYPE}, named with --states; it has "
            + (", ".join(states) or f"none, only {_listed(types)}")
        )
    return matching[0]


def _command_topic(path: Path, types: dict[str, str], states: str, mapping: Mapping) -> str | None:
    """The topic of the command; None if it is the effort on the topic ``states``."""
    if mapping.command == "effort":
        return None
    if mapping.command:
        matching = [topic for topic in types if topic.strip("/") == mapping.command.strip("/")]
    else:
        others = [topic for topic in types if topic not in (states, PARAMETER_EVENTS, ROSOUT)]
        matching = [topic for name in COMMANDS for topic in others if name in last_part(topic)]
    if not matching:
        raise ParameterError(
            f"{path}: no command {mapping.command or ''}".rstrip()
            + f"; name its topic with --command (effort: that of {states}); it has {_listed(types)}"
        )
    return matching[0]


def _listed(types: dict[str, str]) -> str:
    return ", ".join(f"{topic} ({name})" for topic, name in types.items()) or "no topics"


class JointSample(NamedTuple):
    """A message: time stamp [s], x = (φ, φ̇, θ, θ̇), the arm's effort; NaN where not given."""

    stamp: float
    state: tuple[float, ...]
    effort: float


def joint_sample(message: Any, arm: str, pendulum: str) -> JointSample:
    """State of the joints named ``arm`` and ``pendulum`` in a JointState message."""
    x, effort, names = [nan] * 4, nan, list(message.name)
    for joint, angle, speed in ((arm, PHI, PHI_DOT), (pendulum, THETA, THETA_DOT)):
        if joint in names:
            index = names.index(joint)
            x[angle] = _at(message.position, index)
            x[speed] = _at(message.velocity, index)
    if arm in names:
        effort = _at(message.effort, names.index(arm))
    return JointSample(stamp_nanoseconds(message) / NANOSECONDS, tuple(x), effort)


def _at(series: Any, index: int) -> float:
    return float(series[index]) if index < len(series) else nan


def _command_value(path: Path, message: Any) -> float:
    """The command in a message: its data, or the first element of an array."""
    value = getattr(message, "data", None)
    if value is None:
        raise ParameterError(
            f"{path}: a command needs a number in `data`, the type {message.__msgtype__} has none"
        )
    if isinstance(value, (int, float)):
        return float(value)
    if not len(value):
        raise ParameterError(f"{path}: a command message has an empty array")
    return float(value[0])


class _Content:
    """Samples and commands read so far, with their times of arrival [s]."""

    def __init__(self, path: Path, mapping: Mapping, effort_is_past: bool) -> None:
        self._path, self._mapping, self._effort_is_past = path, mapping, effort_is_past
        self._joints: tuple[str, str] | None = None
        self._arrivals: list[float] = []
        self._commands: list[tuple[float, float]] = []
        self.samples: list[JointSample] = []
        self._about_joints = ""

    def add(self, is_state: bool, time: float, message: Any) -> None:
        """Add a message that arrived at ``time`` [s]."""
        if not is_state:
            self._commands.append((time, _command_value(self._path, message)))
            return
        if self._joints is None:
            names = list(message.name)
            self._joints, self._about_joints = joints_of(self._path, names, self._mapping)
        self._arrivals.append(time)
        self.samples.append(joint_sample(message, *self._joints))

    def recording(self, command_is_effort: bool) -> Recording:
        """Times are the stamps in the messages or, if these stand still, the times of arrival."""
        stamps = np.array([sample.stamp for sample in self.samples])
        time = stamps if np.ptp(stamps) > 0.0 else np.array(self._arrivals)
        commands = self._commands
        if command_is_effort:
            efforts = [sample.effort for sample in self.samples]
            # The effort of our measurements is the torque since the previous one.
            begin = np.append(2 * time[0] - time[1], time[:-1]) if self._effort_is_past else time
            commands = list(zip(begin, efforts, strict=True))
        u = np.array(commands) if commands else np.zeros((0, 2))
        measured = np.array([sample.state for sample in self.samples])
        start = time[0]
        name = self._path.name or self._path.resolve().name  # that of . is empty
        recording = Recording(name, time - start, measured, u[:, 0] - start, u[:, 1])
        return recording.noting(self._about_joints) if self._about_joints else recording


def _with_recorded_drive(recording: Recording, bag: Path) -> Recording:
    """The recording with the drive of the parameters stored in the bag, if there are any."""
    try:
        file = parameter_file_of(bag)
        plant = {s.key: s.parameters for s in read_sections(file)}["plant"] if file else {}
        given = {name: plant[name] for name in ("actuator.voltage_range", "actuator.bits")}
        actuator = build(Actuator, given, "actuator.")
    except (ParameterError, KeyError):  # no such file, or not of a simulated plant
        return recording
    return recording.through_drive(actuator, "the bag")
