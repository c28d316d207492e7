"""Copies what is still readable of a damaged bag into a new bag."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.damaged_mcap import mcap_messages
from furuta_recordings.bags.damaged_message import DamagedError, FoundMessage
from furuta_recordings.bags.damaged_sqlite import sqlite_messages
from furuta_recordings.bags.mcap_records import BagTopic
from furuta_recordings.bags.metadata import PARAMETERS_FILE
from furuta_recordings.bags.writer import BagWriter


def recover(bag: Path, out: Path) -> dict[str, object]:
    """Copy the readable messages of ``bag`` (directory or file) into a new bag ``out``.

    The result has the keys bag, messages and problems (why the rest was left out).
    """
    files = _data_files(bag)
    if not files:
        raise ParameterError(f"{bag} has no .mcap and no .db3 file: nothing to recover")
    if out.exists():
        raise ParameterError(f"{out} already exists; name another directory for the bag")
    problems: list[str] = []
    topics = _topics(files, problems)
    if not topics:
        raise ParameterError(f"{bag} has no message that can be read")
    file = bag / PARAMETERS_FILE
    parameters = {PARAMETERS_FILE: file.read_text(errors="replace")} if file.is_file() else {}
    writer = BagWriter(out, topics, parameters)
    messages = _copy(files, topics, writer, problems)
    writer.close()
    return {"bag": str(out), "messages": messages, "problems": problems}


def _data_files(bag: Path) -> list[Path]:
    files = [bag] if bag.is_file() else bag.iterdir() if bag.is_dir() else []
    found = [file for file in files if file.suffix in (".mcap", ".db3")]
    return sorted(found, key=lambda file: (len(file.name), file.name))  # bag_2 before bag_10


def _copy(files: list[Path], topics: list[BagTopic], writer: BagWriter, problems: list[str]) -> int:
    """Write all readable messages of the known topics; returns their number."""
    place = {(topic.name, topic.type_name): index for index, topic in enumerate(topics)}
    messages = 0
    for found in readable_messages(files, problems):
        index = place.get((found.topic.name, found.topic.type_name))
        if index is not None:
            writer.add(index, found.time, found.data)
            messages += 1
    return messages


def readable_messages(files: list[Path], problems: list[str]) -> Iterator[FoundMessage]:
    """All messages that can be read; why others cannot is appended to ``problems``."""
    for file in files:
        read = sqlite_messages if file.suffix == ".db3" else mcap_messages
        try:
            yield from read(file, problems)
        except (DamagedError, OSError, ValueError, sqlite3.Error) as error:
            problems.append(f"{file.name}: {error}")


def _topics(files: list[Path], problems: list[str]) -> list[BagTopic]:
    """Topics of all messages whose type is known, ordered by their first message."""
    topics: dict[tuple[str, str], BagTopic] = {}
    for found in readable_messages(files, []):
        topics.setdefault((found.topic.name, found.topic.type_name), found.topic)
    usable = []
    for topic in topics.values():
        try:
            usable.append(topic._replace(definition=_definition(topic)))
        except DamagedError as damage:
            problems.append(f"left out {topic.name}: {damage}")
    return usable


def _definition(topic: BagTopic) -> str:
    """The definition of a topic's type: the bag's own if it can be parsed, otherwise ROS's."""
    if topic.definition:
        with suppress(Exception):  # a parser may raise anything
            get_types_from_msg(topic.definition, topic.type_name)
            return topic.definition
    types = get_typestore(Stores.ROS2_JAZZY)
    if topic.type_name not in types.types:
        raise DamagedError(f"its type {topic.type_name!r} is not defined anywhere")
    return types.generate_msgdef(topic.type_name, ros_version=2)[0]
