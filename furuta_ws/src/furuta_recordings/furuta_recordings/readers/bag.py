"""Reads recordings from bags of any origin: joint states and a command."""

from __future__ import annotations

from array import array
from collections.abc import Collection, Sequence
from itertools import islice
from math import nan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from furuta_model.converter import Actuator
from furuta_model.parameters import ParameterError, build
from furuta_recordings.bags.bag import Bag, last_part
from furuta_recordings.bags.bag_files import parameter_file_of
from furuta_recordings.bags.recorded_loop import JOINT_STATE_TYPE
from furuta_recordings.readers.assembly import Joint, recording_of
from furuta_recordings.readers.mapping import COMMANDS, NO_COMMAND, Mapping, joints_of, only_one
from furuta_recordings.recording import Recording
from furuta_ros.parameter_files import read_sections
from furuta_ros.time_stamps import NANOSECONDS, stamp_nanoseconds
from furuta_ros.topic_names import JOINT_STATES, JOINTS, MEASUREMENT, PARAMETER_EVENTS, ROSOUT

# The name of a command that is the effort of the joint states.
EFFORT = "effort"
# Joints of which all is kept, besides those that are named.
FEW_JOINTS = 2
# Time [s] between stamp and arrival that no recorder needs, and the part of the samples that may
# need it nevertheless.
LARGEST_DELAY, FEW = 0.5, 0.1


def read_bag(path: Path, mapping: Mapping) -> Recording:
    """A recording from a bag of joint states and a command."""
    driven = mapping.command != NO_COMMAND
    content = _read(path, mapping, driven, {*JOINTS, mapping.arm, mapping.pendulum})
    (arm, pendulum), about_joints = joints_of(path, list(content.joints), mapping)
    recording = content.recording([arm, pendulum], about_joints)
    return _with_recorded_drive(recording, path)


def read_bag_axis(path: Path, joint: str | None, command: str | None) -> Recording:
    """A recording of one joint in a bag, as the arm alone; driven by its effort by default."""
    content = _read(path, Mapping(command=command or EFFORT), True, {joint})
    names = list(content.joints)
    if joint is not None and joint not in names:
        raise ParameterError(f"{path}: no joint {joint}; it has {', '.join(names) or 'none'}")
    chosen = joint or only_one(path, names, "axis", "--joint")
    recording = content.recording([chosen])
    if not len(recording.command):
        raise ParameterError(
            f"{path}: no effort of joint {chosen}; name the topic of its drive with --command"
        )
    return recording


def _read(path: Path, mapping: Mapping, driven: bool, wanted: Collection[str | None]) -> _Content:
    """The joints ``wanted`` and the first two others, and the commands, of a bag."""
    with Bag(path) as bag:
        types = {c.topic: c.msgtype for c in bag.connections}
        states = _states_topic(path, types, mapping)
        command = _command_topic(path, types, states, mapping) if driven else None
        past = last_part(states) == MEASUREMENT
        content = _Content(path, wanted, driven and command is None, past)
        chosen = [c for c in bag.connections if c.topic in (states, command)]
        for connection, time, data in bag.messages_in_memory(chosen):
            message = bag.deserialize(data, connection.msgtype)
            if connection.topic == states:
                content.add_states(time, message)
            else:
                content.add_command(time, message)
    if not content.joints:
        raise ParameterError(f"{path}: no joint in the messages on {states}")
    return content


def _states_topic(path: Path, types: dict[str, str], mapping: Mapping) -> str:
    """The topic of the joint states among the topics ``types`` (topic: type)."""
    states = [topic for topic, type_name in types.items() if type_name == JOINT_STATE_TYPE]
    if mapping.states:
        matching = [topic for topic in states if topic.strip("/") == mapping.states.strip("/")]
    else:
        usual = [
            [t for t in states if last_part(t) == name] for name in (MEASUREMENT, JOINT_STATES)
        ]
        matching = usual[0] or usual[1] or (states if len(states) == 1 else [])
    if not matching:
        raise ParameterError(
            f"{path}: needs a topic of type {JOINT_STATE_TYPE}, named with --states; it has "
            + (", ".join(states) or f"none, only {_listed(types)}")
        )
    return only_one(path, matching, "topic of the joint states", "--states")


def _command_topic(path: Path, types: dict[str, str], states: str, mapping: Mapping) -> str | None:
    """The topic of the command; None if it is the effort on the topic ``states``."""
    if mapping.command == EFFORT:
        return None
    if mapping.command:
        matching = [topic for topic in types if topic.strip("/") == mapping.command.strip("/")]
    else:
        others = [topic for topic in types if topic not in (states, PARAMETER_EVENTS, ROSOUT)]
        exact = [topic for topic in others if last_part(topic) in COMMANDS]
        parts = [name for name in COMMANDS if len(name) > 1]
        matching = exact or [t for t in others if any(name in last_part(t) for name in parts)]
    if not matching:
        raise ParameterError(
            f"{path}: no command {mapping.command or ''}".rstrip()
            + f"; name its topic with --command (effort: that of {states}); it has {_listed(types)}"
        )
    return only_one(path, matching, "command", "--command")


def _listed(types: dict[str, str]) -> str:
    return ", ".join(f"{topic} ({name})" for topic, name in types.items()) or "no topics"


def joint_numbers(message: Any, index: int) -> list[float]:
    """Position, velocity and effort of a joint in a JointState message; NaN where not given."""
    series = message.position, message.velocity, message.effort
    return [float(each[index]) if index < len(each) else nan for each in series]


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


class _Joint(NamedTuple):
    """What the messages hold of a joint: their numbers, and position, velocity and effort."""

    rows: array[int]
    values: array[float]


class _Content:
    """What was read so far, with stamps and times of arrival [ns]; a stamp is 0 without one."""

    def __init__(
        self, path: Path, wanted: Collection[str | None], effort_drives: bool, effort_is_past: bool
    ) -> None:
        self._path, self._wanted = path, wanted
        self._effort_drives, self._effort_is_past = effort_drives, effort_is_past
        self._states = array("q"), array("q")
        self._commands = array("q"), array("q"), array("d")
        self.joints: dict[str, _Joint] = {}

    def add_states(self, time: int, message: Any) -> None:
        """Add what a message that arrived at ``time`` [ns] holds of each joint."""
        stamps, arrivals = self._states
        for index, name in enumerate(message.name):
            if name not in self.joints:
                self.joints[name] = _Joint(array("q"), array("d"))
            if name in self._wanted or name in [*islice(self.joints, FEW_JOINTS)]:
                rows, values = self.joints[name]
                rows.append(len(stamps))
                values.extend(joint_numbers(message, index))
        stamps.append(stamp_nanoseconds(message))
        arrivals.append(time)

    def add_command(self, time: int, message: Any) -> None:
        """Add a command that arrived at ``time`` [ns]."""
        stamps, arrivals, values = self._commands
        stamps.append(stamp_nanoseconds(message) if hasattr(message, "header") else 0)
        arrivals.append(time)
        values.append(_command_value(self._path, message))

    def recording(self, names: Sequence[str], finding: str = "") -> Recording:
        """The recording of the joints of these names."""
        count = len(self._states[0])
        series = np.full((len(names), count, 3), np.nan)
        for index, name in enumerate(names):
            rows, values = self.joints[name]
            series[index, np.array(rows, int)] = np.array(values).reshape(-1, 3)
        ordered = [
            Joint.of(position, velocity, "", 1.0) for position, velocity, _ in series.swapaxes(1, 2)
        ]
        time, commands, about_times = self._times(series[0, :, 2])
        name = self._path.name or self._path.resolve().name  # that of . is empty
        return recording_of(name, ordered, time, commands, (finding, about_times))

    def _times(self, effort: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray], str]:
        """Times of the samples [s], commands, and how times were taken.

        Stamps count, unless they stand still or come from another clock than the commands, of
        which those without a stamp have that of the arrival.
        """
        stamps, arrivals = (np.array(each, np.int64) for each in self._states)
        begin = arrivals[0]
        state_time, state_arrival = (stamps - begin) / NANOSECONDS, (arrivals - begin) / NANOSECONDS
        has_stamps = bool(np.ptp(stamps) > 0)
        if self._effort_drives:
            time = state_time if has_stamps else state_arrival
            # The effort of our measurements is the torque since the previous one.
            before = np.append(2 * time[0] - time[1], time[:-1]) if len(time) > 1 else time
            return time, (before if self._effort_is_past else time, effort), ""
        given, received, values = (np.array(each) for each in self._commands)
        told = given if np.all(given > 0) else received
        ahead = np.median(told - received) if len(told) else 0
        apart = np.abs(stamps - arrivals - ahead) / NANOSECONDS > LARGEST_DELAY
        if has_stamps and not (len(told) and np.mean(apart) > FEW):
            return state_time, ((told - begin) / NANOSECONDS, values), ""
        seconds = np.median(stamps - arrivals - ahead) / NANOSECONDS
        about = (
            f"stamps of the joint states are {seconds:.6g} s from the clock of the commands: times "
            "of arrival used for both"
        )
        return state_arrival, ((received - begin) / NANOSECONDS, values), about * has_stamps


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
