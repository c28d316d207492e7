"""Reads messages from bag files that may be damaged."""

import sqlite3
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from mcap.records import Channel, Chunk, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from furuta_recordings.bags.decompression import decompress_chunk
from furuta_recordings.bags.limits import (
    LARGEST_CHUNK,
    MOST_TOPICS,
    DamagedError,
    note,
)
from furuta_recordings.bags.metadata import BagTopic
from furuta_recordings.bags.sqlite_files import open_sqlite


class StoredMessage(NamedTuple):
    """A message with its topic, its time [ns] and its serialized content."""

    topic: BagTopic
    time: int
    data: bytes


def readable_messages(files: list[Path], problems: list[str]) -> Iterator[StoredMessage]:
    """All messages that can be read; why others cannot is appended to ``problems``."""
    for file in files:
        read = _sqlite_messages if file.suffix == ".db3" else _mcap_messages
        try:
            yield from read(file, problems)
        except (DamagedError, OSError, ValueError, sqlite3.Error) as error:
            note(problems, f"{file.name}: {error}")


def _sqlite_messages(file: Path, problems: list[str]) -> Iterator[StoredMessage]:
    with open_sqlite(file) as connection:
        topics = {
            number: BagTopic(str(name), str(type_name), "", "")
            for number, name, type_name in connection.execute(
                f"SELECT id, name, type FROM topics LIMIT {MOST_TOPICS}"
            )
        }
        rows = connection.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY id")
        for number, time, data in rows:
            usable = isinstance(data, bytes) and isinstance(time, int) and 0 <= time < 2**63
            if number in topics and usable:
                yield StoredMessage(topics[number], time, data)
            else:
                note(problems, f"{file.name}: left out a damaged message")


def _mcap_messages(file: Path, problems: list[str]) -> Iterator[StoredMessage]:
    """Messages of an MCAP file, record by record; a damaged chunk is left out."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    with file.open("rb") as stream:
        for record in _mcap_records(file, stream, problems):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message) and (message := _message(record, channels, schemas)):
                yield message


def _mcap_records(file: Path, stream: object, problems: list[str]) -> Iterator[McapRecord]:
    """The records of a file, those in chunks included, up to the first that has no length."""
    reader = StreamReader(stream, emit_chunks=True, record_size_limit=2 * LARGEST_CHUNK)  # type: ignore[arg-type]
    records = reader.records
    while True:
        try:
            record = next(records)
        except StopIteration:
            return
        except Exception as error:  # a reader of damaged data may raise anything
            raise DamagedError(f"ends with a damaged record ({type(error).__name__})") from None
        if not isinstance(record, Chunk):
            yield record
            continue
        try:
            data = decompress_chunk(record.data, record.uncompressed_size, record.compression)
            inner = breakup_chunk(replace(record, data=data, compression=""), validate_crc=True)
        except Exception as error:  # so may a decompressor
            note(problems, f"{file.name}: left out a chunk that cannot be read ({error})")
            continue
        yield from inner


def _message(
    record: Message, channels: dict[int, Channel], schemas: dict[int, Schema]
) -> StoredMessage | None:
    channel = channels.get(record.channel_id)
    schema = schemas.get(channel.schema_id) if channel else None
    if channel is None or schema is None:
        return None
    qos = channel.metadata.get("offered_qos_profiles", "")
    definition = schema.data.decode(errors="replace")
    return StoredMessage(
        BagTopic(channel.topic, schema.name, definition, qos), record.log_time, record.data
    )
