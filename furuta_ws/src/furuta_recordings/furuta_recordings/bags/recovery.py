"""Copies what is still readable of a damaged bag into a new bag."""

import os
from contextlib import suppress
from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag_files import file_in
from furuta_recordings.bags.damaged_bags import readable_messages
from furuta_recordings.bags.limits import MOST_TOPICS, DamagedError, note
from furuta_recordings.bags.message_types import JAZZY, definition_of, type_hash, typestore_of
from furuta_recordings.bags.metadata import PARAMETERS_FILE, BagTopic
from furuta_recordings.bags.writer import BagWriter
from furuta_ros.regular_files import read_text
from furuta_ros.yaml_files import LARGEST_FILE, parse_yaml

_SUFFIXES = (".mcap", ".db3")


def recover(bag: Path, out: Path) -> dict[str, object]:
    """Copy the readable messages of ``bag`` (directory or file) into a new bag ``out``.

    The result has the keys bag, messages and problems (why the rest was left out).
    """
    problems: list[str] = []
    files = _data_files(bag, problems)
    if not files:
        reason = "".join(f" ({problem})" for problem in problems[:1])
        raise ParameterError(f"{bag} has no .mcap and no .db3 file: nothing to recover{reason}")
    if os.path.lexists(out):
        raise ParameterError(f"{out} already exists; name another directory for the bag")
    topics = _topics(files, problems)
    if not topics:
        raise ParameterError(f"{bag} has no message that can be read")
    writer = BagWriter(out, topics, _parameters(bag, problems))
    messages = _copy(files, topics, writer, problems)
    writer.close()
    return {"bag": str(out), "messages": messages, "problems": problems}


def _data_files(bag: Path, problems: list[str]) -> list[Path]:
    if bag.is_file():
        return [bag] if bag.suffix in _SUFFIXES else []
    names = [file.name for file in bag.iterdir()] if bag.is_dir() else []
    files = []
    for name in sorted(names, key=lambda name: (len(name), name)):  # bag_2 before bag_10
        try:
            files += [file_in(bag, name)] if Path(name).suffix in _SUFFIXES else []
        except DamagedError as damage:
            note(problems, str(damage))
    return files


def _parameters(bag: Path, problems: list[str]) -> dict[str, str]:
    """The parameter file of the damaged bag, if it has one."""
    if not os.path.lexists(bag / PARAMETERS_FILE):
        return {}
    try:
        file = file_in(bag, PARAMETERS_FILE)
        return {PARAMETERS_FILE: read_text(file, "parameter file", LARGEST_FILE)}
    except (DamagedError, ParameterError) as error:
        note(problems, f"left out {PARAMETERS_FILE}: {error}")
        return {}


def _copy(files: list[Path], topics: list[BagTopic], writer: BagWriter, problems: list[str]) -> int:
    """Write all readable messages of the known topics; returns their number."""
    place = {(topic.name, topic.type_name): index for index, topic in enumerate(topics)}
    messages = 0
    for message in readable_messages(files, problems):
        index = place.get((message.topic.name, message.topic.type_name))
        if index is not None:
            writer.add(index, message.time, message.data)
            messages += 1
    return messages


def _topics(files: list[Path], problems: list[str]) -> list[BagTopic]:
    """Topics of all messages whose type is known, ordered by their first message."""
    topics: dict[tuple[str, str], BagTopic] = {}
    for message in readable_messages(files, []):
        topics.setdefault((message.topic.name, message.topic.type_name), message.topic)
        if len(topics) > MOST_TOPICS:
            raise ParameterError(f"{files[0].parent} has more than {MOST_TOPICS} topics")
    usable = []
    for topic in topics.values():
        try:
            usable.append(_described(topic))
        except DamagedError as damage:
            note(problems, f"left out {topic.name}: {damage}")
    return usable


def _described(topic: BagTopic) -> BagTopic:
    """The topic with definition and hash of its type, and quality of service that can be read."""
    definition = _definition(topic)
    try:
        parse_yaml(topic.qos, "quality of service")
    except ParameterError:
        topic = topic._replace(qos="")
    hashed = type_hash(topic.type_name, definition)
    return topic._replace(definition=definition, type_hash=hashed)


def _definition(topic: BagTopic) -> str:
    """The definition of a topic's type: the bag's own if it can be parsed, otherwise ROS's."""
    if topic.definition:
        with suppress(Exception):  # a parser may raise anything
            typestore_of(topic.type_name, topic.definition)
            return topic.definition
    if topic.type_name not in JAZZY.types:
        raise DamagedError(f"its type {topic.type_name!r} is not defined anywhere")
    return definition_of(topic.type_name)
