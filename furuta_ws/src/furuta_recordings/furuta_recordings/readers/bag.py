"""Reads recordings from bags of any origin: joint states and a command."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError, build
from furuta_model.sensors import Actuator
from furuta_recordings.bags.bag import Bag, last_part, parameter_file_of
from furuta_recordings.bags.series import JOINT_STATE, STATE_TYPES, Series, read_series
from furuta_recordings.readers.assembly import Joint, recording_of
from furuta_recordings.readers.mapping import COMMANDS, NO_COMMAND, Mapping, joints_of, only_one
from furuta_recordings.recording import Recording
from furuta_ros.parameter_files import read_sections
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import JOINT_STATES, MEASUREMENT, PARAMETER_EVENTS, ROSOUT

# The name of a command that is the effort of the joint states.
EFFORT = "effort"
# Time [s] between stamp and arrival that no recorder needs, and the part of the samples that may
# need it nevertheless.
LARGEST_DELAY, FEW = 0.5, 0.1


def read_bag(path: Path, mapping: Mapping) -> Recording:
    """A recording from a bag of joint states and a command."""
    content = _read(path, mapping)
    (arm, pendulum), about_joints = joints_of(path, list(content.states.joints), mapping)
    recording = content.recording([arm, pendulum], about_joints)
    return _with_recorded_drive(recording, path)


def read_bag_axis(path: Path, joint: str | None, command: str | None) -> Recording:
    """A recording of one joint in a bag, as the arm alone; driven by its effort by default."""
    drive = Mapping(command=command or EFFORT)
    with Bag(path) as bag:
        types = {c.topic: c.msgtype for c in bag.connections}

        @cache
        def read(kind: str) -> dict[str, Series]:
            return read_series(bag, [topic for topic, name in types.items() if name == kind])

        if joint is None:
            _, states = _axis_states(path, read, types, None, with_effort=False)
            joint = only_one(path, list(states.joints), "axis", "--joint")
        topic, states = _axis_states(path, read, types, joint, drive.command == EFFORT)
        driven = None if command == NO_COMMAND else _command_topic(path, types, topic, drive)
        commands = Series() if driven is None else read_series(bag, [driven])[driven]
    own = states.of_joint(joint)
    about = f"position of {joint} from {topic}" * (types[topic] != JOINT_STATE)
    # A measured effort is that before its sample, a commanded one that after it. The fit finds a
    # delay, but none below 0.
    effort_drives = driven is None and command != NO_COMMAND
    content = _Content(path, own, commands, effort_drives, effort_is_past=True)
    recording = content.recording([joint], about)
    if not len(recording.command) and command != NO_COMMAND:
        raise ParameterError(
            f"{path}: no effort of joint {joint}; name the topic of its drive with --command"
        )
    start = recording.start + float(own.arrivals[0]) / NANOSECONDS
    return recording._replace(joint=joint, start=start)


def _axis_states(
    path: Path,
    read: Callable[[str], dict[str, Series]],
    types: dict[str, str],
    joint: str | None,
    with_effort: bool,
) -> tuple[str, Series]:
    """The topic that has the joint, of the first type that has its effort too; what it holds.

    ``read`` reads all topics of a type. Without a joint, the topic of joint states.
    """
    names: dict[str, None] = {}
    holding: dict[str, Series] = {}
    for kind in STATE_TYPES:
        series = read(kind)
        names |= {name: None for each in series.values() for name in each.joints}
        of_kind = {t: s for t, s in series.items() if s.joints and joint in (None, *s.joints)}
        usable = {t: s for t, s in of_kind.items() if not with_effort or _has_effort(s, joint)}
        holding = usable or holding or of_kind
        if usable:
            break
    if not holding:
        missing = f"no joint {joint}; it has {', '.join(names)}" if names else _no_states(types)
        raise ParameterError(f"{path}: {missing}")
    topics = _usual(list(holding))
    if len(topics) > 1:
        hint = "" if joint else "; name the joint with --joint"
        raise ParameterError(f"{path}: joint states on each of {', '.join(topics)}{hint}")
    return topics[0], holding[topics[0]]


def _has_effort(states: Series, joint: str | None) -> bool:
    return joint is not None and bool(np.any(np.isfinite(states.joint(joint)[:, 2])))


def _read(path: Path, mapping: Mapping) -> _Content:
    with Bag(path) as bag:
        types = {c.topic: c.msgtype for c in bag.connections}
        states = _states_topic(path, types, mapping)
        driven = mapping.command != NO_COMMAND
        command = _command_topic(path, types, states, mapping) if driven else None
        series = read_series(bag, [topic for topic in (states, command) if topic is not None])
    if not series[states].joints:
        raise ParameterError(f"{path}: no joint in the messages on {states}")
    commands = series[command] if command is not None else Series()
    past = last_part(states) == MEASUREMENT.name
    return _Content(path, series[states], commands, driven and command is None, past)


def _states_topic(path: Path, types: dict[str, str], mapping: Mapping) -> str:
    """The topic of the joint states among the topics ``types`` (topic: type)."""
    every = [topic for kind in STATE_TYPES for topic, name in types.items() if name == kind]
    if mapping.states:
        matching = [topic for topic in every if topic.strip("/") == mapping.states.strip("/")]
    else:
        matching = _usual([t for t in every if types[t] == JOINT_STATE] or every)
    if not matching:
        asked = f"no joint states on {mapping.states}; " if mapping.states else ""
        raise ParameterError(f"{path}: {asked}{_no_states(types)}")
    return only_one(path, matching, "topic of the joint states", "--states")


def _usual(topics: list[str]) -> list[str]:
    """Of several topics of joint states those with a usual name, if there are any."""
    named = [
        [t for t in topics if last_part(t) == each.name] for each in (MEASUREMENT, JOINT_STATES)
    ]
    return named[0] or named[1] or topics


def _no_states(types: dict[str, str]) -> str:
    return f"needs a topic of one of the types {', '.join(STATE_TYPES)}; it has {_listed(types)}"


def _command_topic(path: Path, types: dict[str, str], states: str, mapping: Mapping) -> str | None:
    """The topic of the command; None if it is the effort on the topic ``states``."""
    if mapping.command == EFFORT:
        return None
    if mapping.command:
        matching = [topic for topic in types if topic.strip("/") == mapping.command.strip("/")]
    else:
        others = [
            topic for topic in types if topic not in (states, PARAMETER_EVENTS.name, ROSOUT.name)
        ]
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


class _Content(NamedTuple):
    """The series of a recording; ``commands`` are empty if the effort drives, or nothing."""

    path: Path
    states: Series
    commands: Series
    effort_drives: bool
    effort_is_past: bool

    def recording(self, names: Sequence[str], finding: str = "") -> Recording:
        """The recording of the joints of these names."""
        joints = [self.states.joint(name) for name in names]
        ordered = [Joint.of(joint[:, 0], joint[:, 1], "", 1.0) for joint in joints]
        time, commands, about_times = self._times(joints[0][:, 2])
        name = self.path.name or self.path.resolve().name  # that of . is empty
        commanded = self.effort_drives and names[0] in self.states.commanded
        about_effort = f"effort of {names[0]}: what its controller commands" * commanded
        return recording_of(name, ordered, time, commands, (finding, about_effort, about_times))

    def _times(self, effort: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray], str]:
        """Times of the samples [s], commands, and how times were taken.

        Stamps count, unless they stand still or come from another clock than the commands, of
        which those without a stamp have that of the arrival.
        """
        stamps, arrivals = self.states.stamps, self.states.arrivals
        begin = arrivals[0]
        state_time, state_arrival = (stamps - begin) / NANOSECONDS, (arrivals - begin) / NANOSECONDS
        has_stamps = bool(np.ptp(stamps) > 0)
        if self.effort_drives:
            time = state_time if has_stamps else state_arrival
            # The effort of our measurements is the torque since the previous one.
            before = np.append(2 * time[0] - time[1], time[:-1]) if len(time) > 1 else time
            return time, (before if self.effort_is_past else time, effort), ""
        drive = self.commands
        given, received, values = drive.stamps, drive.arrivals, drive.values
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
