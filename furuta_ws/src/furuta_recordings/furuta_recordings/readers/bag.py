"""Reads recordings from bags of any origin."""

from pathlib import Path
from typing import Any

import numpy as np

from furuta_model.parameters import ParameterError, build
from furuta_model.parts.converter import Actuator
from furuta_recordings.bags.bag import Bag, last_part
from furuta_recordings.bags.bag_files import file_in
from furuta_recordings.bags.limits import DamagedError
from furuta_recordings.bags.metadata import PARAMETERS_FILE
from furuta_recordings.readers.bag_topics import command_topic, states_topic
from furuta_recordings.readers.drive import through_drive
from furuta_recordings.readers.joint_states import JointSample, command_value, joint_sample
from furuta_recordings.readers.mapping import NO_COMMAND, Mapping, joints_of
from furuta_recordings.recording import Recording
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topic_names import MEASUREMENT
from furuta_ros.yaml_files import read_yaml


def read_bag(path: Path, mapping: Mapping) -> tuple[Recording, list[str]]:
    """A recording from a bag of joint states and a command."""
    with Bag(path) as bag:
        types = {c.topic: c.msgtype for c in bag.connections}
        states = states_topic(path, types, mapping)
        driven = mapping.command != NO_COMMAND
        command = command_topic(path, types, states, mapping) if driven else None
        content = _Content(path, mapping, last_part(states) == MEASUREMENT)
        chosen = [c for c in bag.connections if c.topic in (states, command)]
        for connection, time, message in bag.messages_in_memory(chosen):
            content.add(connection.topic == states, time / NANOSECONDS, message)
    if not content.samples:
        raise ParameterError(f"{path}: no message on {states}")
    recording = content.recording(command_is_effort=driven and command is None)
    return _with_recorded_drive(recording, path / PARAMETERS_FILE, content.notes)


class _Content:
    """Samples and commands read so far, with their times of arrival [s]."""

    def __init__(self, path: Path, mapping: Mapping, effort_is_past: bool) -> None:
        self._path, self._mapping, self._effort_is_past = path, mapping, effort_is_past
        self._joints: tuple[str, str] | None = None
        self._arrivals: list[float] = []
        self._commands: list[tuple[float, float]] = []
        self.samples: list[JointSample] = []
        self.notes: list[str] = []

    def add(self, is_state: bool, time: float, message: Any) -> None:
        """Add a message that arrived at ``time`` [s]."""
        if not is_state:
            self._commands.append((time, command_value(self._path, message)))
            return
        if self._joints is None:
            self._joints, notes = joints_of(self._path, list(message.name), self._mapping)
            self.notes += notes
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
        return Recording(self._path.name, time - start, measured, u[:, 0] - start, u[:, 1])


def _with_recorded_drive(
    recording: Recording, file: Path, notes: list[str]
) -> tuple[Recording, list[str]]:
    """The recording with the drive of the parameters stored in the bag, if there are any."""
    try:
        content = read_yaml(file_in(file.parent, file.name), "parameter file")
        plant = content["plant"]["ros__parameters"]
        given = {name: plant[name] for name in ("actuator.voltage_range", "actuator.bits")}
        actuator = build(Actuator, given, "actuator.")
    except (DamagedError, ParameterError, KeyError, TypeError):
        return recording, notes
    recording, more = through_drive(recording, actuator, "the bag")
    return recording, notes + more
