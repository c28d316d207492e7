"""Copies what is still readable of a damaged bag into a new bag."""

import sqlite3
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from mcap.records import Channel, Chunk, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import Bag
from furuta_recordings.bags.bag_files import check_values, file_in, open_sqlite, parameter_file_of
from furuta_recordings.bags.limits import LARGEST_CHUNK, MOST_TOPICS, decompress_chunk
from furuta_recordings.bags.message_types import JAZZY, definition_of, type_hash, typestore_of
from furuta_recordings.bags.metadata import PARAMETERS_FILE, BagTopic
from furuta_recordings.bags.writer import BagWriter
from furuta_ros.yaml_files import parse_yaml, read_text

_SUFFIXES = (".mcap", ".db3")
# Most problems that a recovery lists.
MOST_PROBLEMS = 100

# A message: its topic, its time [ns] and its content.
StoredMessage = tuple[BagTopic, int, bytes]


def recover(bag: Path, out: Path) -> dict[str, object]:
    """Copy the readable messages of ``bag`` (directory or file) into a new bag ``out``.

    The result has the keys bag, messages and problems (why the rest was left out).
    """
    return _Recovery(bag, out).run()


class _Recovery:
    def __init__(self, bag: Path, out: Path) -> None:
        self._bag, self._out = bag, out
        self._problems: list[str] = []
        # Index of each topic (name, type) in the new bag; None if it is left out.
        self._topics: dict[tuple[str, str], int | None] = {}
        self._beyond = 0  # messages on more topics than a bag may have
        self._writer: BagWriter | None = None

    def run(self) -> dict[str, object]:
        files = self._data_files()
        if not files:
            raise ParameterError(
                f"{self._bag} has no .mcap and no .db3 file: nothing to recover{self._reason()}"
            )
        messages = 0
        for file in files:
            for topic, time, data in self._readable_messages(file):
                index = self._index_of(topic)
                if not 0 <= time < 2**63:
                    self._note(f"{file.name}: left out a message with the time {time} ns")
                elif self._writer and index is not None:
                    self._writer.add(index, time, data)
                    messages += 1
        if self._writer is None:
            raise ParameterError(f"{self._bag} has no message that can be read{self._reason()}")
        self._writer.close()
        with Bag(self._out):  # what is written must be readable
            pass
        if self._beyond:
            raise ParameterError(
                f"{self._out} lacks {self._beyond} messages on topics after the first "
                f"{MOST_TOPICS}, the most that a bag may have; it holds {messages} messages"
            )
        return {"bag": str(self._out), "messages": messages, "problems": self._problems}

    def _note(self, problem: str) -> None:
        if len(self._problems) == MOST_PROBLEMS:
            problem = "further problems are not listed"
        if len(self._problems) <= MOST_PROBLEMS:
            self._problems.append(problem)

    def _reason(self) -> str:
        return "".join(f" ({problem})" for problem in self._problems[:1])

    def _data_files(self) -> list[Path]:
        if self._bag.is_file():
            return [self._bag] if self._bag.suffix in _SUFFIXES else []
        names = [file.name for file in self._bag.iterdir()] if self._bag.is_dir() else []
        files = []
        for name in sorted(names, key=lambda name: (len(name), name)):  # bag_2 before bag_10
            try:
                files += [file_in(self._bag, name)] if Path(name).suffix in _SUFFIXES else []
            except ParameterError as error:
                self._note(str(error))
        return files

    def _parameters(self) -> dict[str, str]:
        """The parameter file of the damaged bag, if it has one."""
        try:
            file = parameter_file_of(self._bag)
            text = "" if file is None else read_text(file, "parameter file")
        except ParameterError as error:
            self._note(f"left out {PARAMETERS_FILE}: {error}")
            return {}
        return {PARAMETERS_FILE: text} if text else {}

    def _index_of(self, topic: BagTopic) -> int | None:
        """The topic's index in the new bag, which begins with the first usable message."""
        key = topic.name, topic.type_name
        if key not in self._topics:
            if len(self._topics) == MOST_TOPICS:
                self._beyond += 1
                return None
            self._topics[key] = None
            try:
                described = _described(topic)
            except ParameterError as error:
                self._note(f"left out {topic.name}: {error}")
            else:
                if self._writer is None:
                    self._writer = BagWriter(self._out, [], self._parameters())
                self._topics[key] = self._writer.add_topic(described)
        return self._topics[key]

    def _readable_messages(self, file: Path) -> Iterator[StoredMessage]:
        """All messages of a file that can be read; why others cannot is noted."""
        read = self._sqlite_messages if file.suffix == ".db3" else self._mcap_messages
        try:
            yield from read(file)
        except Exception as error:  # a reader of damaged data may raise anything
            self._note(f"{file.name}: ends with a damaged record ({error})")

    def _sqlite_messages(self, file: Path) -> Iterator[StoredMessage]:
        with open_sqlite(file) as connection:
            try:
                check_values(connection)
            except (ParameterError, sqlite3.Error) as error:  # what comes before may be sound
                self._note(f"{file.name}: {error}")
            rows = connection.execute(f"SELECT id, name, type FROM topics LIMIT {10 * MOST_TOPICS}")
            topics = {
                number: BagTopic(name, type_name, "", "")
                for number, name, type_name in rows
                if isinstance(name, str) and isinstance(type_name, str)
            }
            rows = connection.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY id")
            for number, time, data in rows:
                if number in topics and isinstance(data, bytes) and isinstance(time, int):
                    yield topics[number], time, data
                else:
                    self._note(f"{file.name}: left out a damaged message")

    def _mcap_messages(self, file: Path) -> Iterator[StoredMessage]:
        """Messages of an MCAP file, record by record."""
        schemas: dict[int, Schema] = {}
        channels: dict[int, Channel] = {}
        for record in self._mcap_records(file):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                channel = channels.get(record.channel_id)
                schema = schemas.get(channel.schema_id) if channel else None
                if channel is None or schema is None:
                    self._note(f"{file.name}: left out a message without channel or schema")
                    continue
                qos = channel.metadata.get("offered_qos_profiles", "")
                definition = schema.data.decode(errors="replace")
                topic = BagTopic(channel.topic, schema.name, definition, qos)
                yield topic, record.log_time, record.data

    def _mcap_records(self, file: Path) -> Iterator[McapRecord]:
        """The records of a file, those in chunks included; a damaged chunk is left out."""
        with file.open("rb") as stream:
            limit = 2 * LARGEST_CHUNK
            for record in StreamReader(stream, emit_chunks=True, record_size_limit=limit).records:
                if not isinstance(record, Chunk):
                    yield record
                    continue
                try:
                    size, compression = record.uncompressed_size, record.compression
                    data = decompress_chunk(record.data, size, compression)
                    content = replace(record, data=data, compression="")
                    inner = breakup_chunk(content, validate_crc=True)
                except Exception as error:  # a decompressor may raise anything
                    self._note(f"{file.name}: left out a chunk that cannot be read ({error})")
                else:
                    yield from inner


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
        raise ParameterError(f"its type {topic.type_name!r} is not defined anywhere")
    return definition_of(topic.type_name)
