"""Messages of broken bag files, MCAP and sqlite3, up to where they break."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Iterator
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, McapRecord, Message, Schema
from mcap.stream_reader import breakup_chunk

from furuta_recordings.bags.mcap_file import MAGIC, Kind

# No record of a sound bag is longer [bytes]: what says so is broken.
LONGEST_RECORD = 2**28
_HEAD = struct.Struct("<BQ")
_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 3, 4, 5, 6, 15


class Found(NamedTuple):
    """A message: topic and type, time [ns], content."""

    kind: Kind
    time: int
    data: bytes


class DamagedError(Exception):
    """Here the sound part of a file ends, with the reason in words."""


def salvage(files: list[Path], reasons: list[str]) -> Iterator[Found]:
    """All messages that can be read; why others cannot goes into ``reasons``."""
    for file in files:
        read = _of_sqlite if file.suffix == ".db3" else _of_mcap
        try:
            yield from read(file, reasons)
        except (DamagedError, OSError, ValueError, sqlite3.Error) as error:
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
            raise DamagedError("no MCAP file")
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
            raise DamagedError("ends within a record")
        opcode, length = _HEAD.unpack(head)
        if opcode in (0, _DATA_END):
            return
        if length > LONGEST_RECORD:
            if opcode >= 0x80:
                return
            raise DamagedError(f"a record that claims {length} bytes")
        content = stream.read(length)
        if len(content) < length:
            raise DamagedError("ends within a record")
        try:
            yield from _of_record(opcode, content, schemas, channels)
        except DamagedError as broken:
            if reasons is None:
                raise
            reasons.append(f"left out {broken}")


def _of_record(
    opcode: int, content: bytes, schemas: dict[int, Schema], channels: dict[int, Channel]
) -> Iterator[Found]:
    try:
        yield from _of_sound_record(opcode, content, schemas, channels)
    except (struct.error, ValueError, KeyError, EOFError, ArithmeticError, McapError) as error:
        raise DamagedError(f"a malformed record ({type(error).__name__})") from None


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
            raise DamagedError(f"a chunk that claims {chunk.uncompressed_size} bytes")
        try:
            records = breakup_chunk(chunk, validate_crc=True)
        except Exception as error:  # whatever a decompressor raises
            raise DamagedError(f"a chunk that cannot be read ({error})") from None
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
