"""Finds the topics of states and command in a bag."""

from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import last_part
from furuta_recordings.readers.mapping import COMMANDS, Mapping
from furuta_ros.topic_names import JOINT_STATES, MEASUREMENT, PARAMETER_EVENTS, ROSOUT

JOINT_STATE_TYPE = "sensor_msgs/msg/JointState"


def states_topic(path: Path, types: dict[str, str], mapping: Mapping) -> str:
    """The topic of the joint states among the topics ``types`` (topic: type)."""
    states = [topic for topic, type_name in types.items() if type_name == JOINT_STATE_TYPE]
    if mapping.states:
        found = [topic for topic in states if topic.strip("/") == mapping.states.strip("/")]
    else:
        usual = (MEASUREMENT, JOINT_STATES)
        found = [topic for name in usual for topic in states if last_part(topic) == name]
        found = found or (states if len(states) == 1 else [])
    if not found:
        raise ParameterError(
            f"{path}: needs a topic of type {JOINT_STATE_TYPE}, named with --states; it has "
            + (", ".join(states) or f"none, only {_listed(types)}")
        )
    return found[0]


def command_topic(path: Path, types: dict[str, str], states: str, mapping: Mapping) -> str | None:
    """The topic of the command; None if it is the effort on the topic ``states``."""
    if mapping.command == "effort":
        return None
    if mapping.command:
        found = [topic for topic in types if topic.strip("/") == mapping.command.strip("/")]
    else:
        others = [topic for topic in types if topic not in (states, PARAMETER_EVENTS, ROSOUT)]
        found = [topic for name in COMMANDS for topic in others if name in last_part(topic)]
    if not found:
        raise ParameterError(
            f"{path}: no command {mapping.command or ''}".rstrip()
            + f"; name its topic with --command (effort: that of {states}); it has {_listed(types)}"
        )
    return found[0]


def _listed(types: dict[str, str]) -> str:
    return ", ".join(f"{topic} ({name})" for topic, name in types.items()) or "no topics"
