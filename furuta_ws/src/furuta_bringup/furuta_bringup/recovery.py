"""What is left of a broken bag, read record by record up to where it breaks."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, McapRecord, Message, Schema
from mcap.stream_reader import breakup_chunk
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from furuta_model.parameters import ParameterError

from .bag_writer import BagWriter
from .mcap_file import MAGIC, Kind
from .recorder import PARAMETERS_FILE

# No record of a sound bag is longer [bytes]: what says so is broken.
LONGEST_RECORD = 2**28
_HEAD = struct.Struct("<BQ")
_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 3, 4, 5, 6, 15


class Found(NamedTuple):
    """A message: topic and type, time [ns], content."""

    kind: Kind
    time: int
    data: bytes


class BrokenError(Exception):
    """Here the sound part of a file ends, with the reason in words."""


def recover(bag: Path, out: Path) -> dict[str, object]:
    """Write what can be read of ``bag`` (directory or file) into a new bag ``out``."""
    files = sorted(
        (
            file
            for file in ([bag] if bag.is_file() else bag.iterdir() if bag.is_dir() else [])
            if file.suffix in (".mcap", ".db3")
        ),
        key=lambda file: (len(file.name), file.name),  # bag_2 before bag_10
    )
    if not files:
        raise ParameterError(f"{bag} holds no .mcap and no .db3 file: nothing to recover")
    if out.exists():
        raise ParameterError(f"{out} exists already; name another directory for the bag")
    reasons: list[str] = []
    kinds = _kinds(files, reasons)
    if not kinds:
        raise ParameterError(f"{bag} holds nothing that can be read as a bag")
    kept = bag / PARAMETERS_FILE
    parameters = {PARAMETERS_FILE: kept.read_text(errors="replace")} if kept.is_file() else {}
    writer = BagWriter(out, kinds, parameters)
    place = {(kind.topic, kind.type_name): index for index, kind in enumerate(kinds)}
    messages = 0
    for found in _messages(files, reasons):
        index = place.get((found.kind.topic, found.kind.type_name))
        if index is not None:
            writer.add(index, found.time, found.data)
            messages += 1
    writer.close()
    return {"bag": str(out), "messages": messages, "problems": reasons}


def _kinds(files: list[Path], reasons: list[str]) -> list[Kind]:
    """Topics of all messages whose type is known, in the order of their first ones."""
    kinds: dict[tuple[str, str], Kind] = {}
    for found in _messages(files, []):
        kinds.setdefault((found.kind.topic, found.kind.type_name), found.kind)
    sound = []
    for kind in kinds.values():
        try:
            sound.append(kind._replace(definition=_definition(kind)))
        except BrokenError as broken:
            reasons.append(f"left out {kind.topic}: {broken}")
    return sound


def _definition(kind: Kind) -> str:
    """The definition of a topic's type: as the bag has it if that is sound, or ROS's own."""
    if kind.definition:
        with suppress(Exception):  # whatever a parser raises
            get_types_from_msg(kind.definition, kind.type_name)
            return kind.definition
    types = get_typestore(Stores.ROS2_JAZZY)
    if kind.type_name not in types.types:
        raise BrokenError(f"nothing defines its type {kind.type_name!r}")
    return types.generate_msgdef(kind.type_name, ros_version=2)[0]


def _messages(files: list[Path], reasons: list[str]) -> Iterator[Found]:
    for file in files:
        read = _of_sqlite if file.suffix == ".db3" else _of_mcap
        try:
            yield from read(file, reasons)
        except (BrokenError, OSError, ValueError, sqlite3.Error) as error:
            reasons.append(f"{file.name}: {error}")


def _of_sqlite(file: Path, reasons: list[str]) -> Iterator[Found]:
    connection = sqlite3.connect(f"file:{file}?mode=ro", uri=True)
    connection.text_factory = partial(str, encoding="utf-8", errors="replace")
    try:
        kinds = {
            number: Kind(str(topic), str(name), "", "")
            for number, topic, name in connection.execute("SELECT id, name, type FROM topics")
        }
        for number, time, data in connection.execute(
            "SELECT topic_id, timestamp, data FROM messages ORDER BY id"
        ):
            if number in kinds and isinstance(data, bytes) and _is_time(time):
                yield Found(kinds[number], time, data)
            else:
                reasons.append(f"{file.name}: left out a damaged message")
    finally:
        connection.close()


def _is_time(value: object) -> bool:
    return isinstance(value, int) and 0 <= value < 2**63


def _of_mcap(file: Path, reasons: list[str]) -> Iterator[Found]:
    with file.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise BrokenError("no MCAP file")
        yield from _of_records(stream, {}, {}, reasons)


def _of_records(
    stream: BinaryIO,
    schemas: dict[int, Schema],
    channels: dict[int, Channel],
    reasons: list[str] | None = None,
) -> Iterator[Found]:
    """Messages of the records of a file or of a chunk, until there is no more or one is broken.

    A broken record of a file is left out, for the next may be sound, and its reason noted.
    """
    while True:
        head = stream.read(_HEAD.size)
        if not head:
            return
        if len(head) < _HEAD.size:
            raise BrokenError("ends within a record")
        opcode, length = _HEAD.unpack(head)
        if opcode in (0, _DATA_END):
            return
        if length > LONGEST_RECORD:
            if opcode >= 0x80:
                return
            raise BrokenError(f"a record that claims {length} bytes")
        content = stream.read(length)
        if len(content) < length:
            raise BrokenError("ends within a record")
        try:
            yield from _of_record(opcode, content, schemas, channels)
        except BrokenError as broken:
            if reasons is None:
                raise
            reasons.append(f"left out {broken}")


def _of_record(
    opcode: int, content: bytes, schemas: dict[int, Schema], channels: dict[int, Channel]
) -> Iterator[Found]:
    try:
        yield from _of_sound_record(opcode, content, schemas, channels)
    except (struct.error, ValueError, KeyError, EOFError, ArithmeticError, McapError) as error:
        raise BrokenError(f"a malformed record ({type(error).__name__})") from None


def _of_sound_record(
    opcode: int, content: bytes, schemas: dict[int, Schema], channels: dict[int, Channel]
) -> Iterator[Found]:
    stream = ReadDataStream(BytesIO(content))
    if opcode == _SCHEMA:
        yield from _of_known(Schema.read(stream), schemas, channels)
    elif opcode == _CHANNEL:
        yield from _of_known(Channel.read(stream), schemas, channels)
    elif opcode == _MESSAGE:
        yield from _of_known(Message.read(stream, len(content)), schemas, channels)
    elif opcode == _CHUNK:
        chunk = Chunk.read(stream)
        if chunk.uncompressed_size > LONGEST_RECORD:
            raise BrokenError(f"a chunk that claims {chunk.uncompressed_size} bytes")
        try:
            records = breakup_chunk(chunk, validate_crc=True)
        except Exception as error:  # whatever a decompressor raises
            raise BrokenError(f"a chunk that cannot be read ({error})") from None
        for record in records:
            yield from _of_known(record, schemas, channels)


def _of_known(
    record: McapRecord, schemas: dict[int, Schema], channels: dict[int, Channel]
) -> Iterator[Found]:
    """A message with its kind; schemas and channels are noted for those that follow."""
    if isinstance(record, Schema):
        schemas[record.id] = record
    elif isinstance(record, Channel):
        channels[record.id] = record
    elif isinstance(record, Message):
        channel = channels[record.channel_id]
        schema = schemas[channel.schema_id]
        qos = channel.metadata.get("offered_qos_profiles", "")
        kind = Kind(channel.topic, schema.name, schema.data.decode(), qos)
        yield Found(kind, record.log_time, record.data)
