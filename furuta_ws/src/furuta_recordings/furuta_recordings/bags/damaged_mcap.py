"""Reads messages from MCAP files that may be damaged, record by record, without the summary."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, McapRecord, Message, Schema
from mcap.stream_reader import breakup_chunk

from furuta_recordings.bags.bounds import LARGEST_CHUNK
from furuta_recordings.bags.damaged_message import DamagedError, FoundMessage, note
from furuta_recordings.bags.decompression import decompress_chunk
from furuta_recordings.bags.mcap_records import FILLER, MAGIC, RECORD_HEAD, BagTopic

# No undamaged record is longer [bytes].
LONGEST_RECORD = 2 * LARGEST_CHUNK
_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 3, 4, 5, 6, 15


def mcap_messages(file: Path, problems: list[str]) -> Iterator[FoundMessage]:
    """All readable messages; a note on each unusable record goes to ``problems``."""
    reader = _RecordReader()
    with file.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise DamagedError("not an MCAP file")
        for opcode, content in _records(stream):
            # A damaged record is left out: the next one may be sound.
            try:
                yield from reader.messages(opcode, content)
            except DamagedError as damage:
                note(problems, f"left out {damage}")


def _records(stream: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """Opcode and content of each record up to the end of the data."""
    size = os.fstat(stream.fileno()).st_size
    while head := stream.read(RECORD_HEAD.size):
        if len(head) < RECORD_HEAD.size:
            raise DamagedError("ends within a record")
        opcode, length = RECORD_HEAD.unpack(head)
        if opcode in (0, _DATA_END):
            return
        if length > LONGEST_RECORD:
            if opcode >= FILLER:
                return
            raise DamagedError(f"a record claims a length of {length} bytes")
        if stream.tell() + length > size:
            raise DamagedError("ends within a record")
        yield opcode, stream.read(length)


class _RecordReader:
    """Decodes records; keeps the schemas and channels that later messages refer to."""

    def __init__(self) -> None:
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}

    def messages(self, opcode: int, content: bytes) -> Iterator[FoundMessage]:
        """The messages in a record; :class:`DamagedError` where it is malformed."""
        try:
            for record in _decoded(opcode, content):
                yield from self._message(record)
        except (struct.error, ValueError, KeyError, EOFError, ArithmeticError, McapError) as error:
            raise DamagedError(f"a malformed record ({type(error).__name__})") from None

    def _message(self, record: McapRecord) -> Iterator[FoundMessage]:
        if isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._channels[record.id] = record
        elif isinstance(record, Message):
            channel = self._channels[record.channel_id]
            schema = self._schemas[channel.schema_id]
            qos = channel.metadata.get("offered_qos_profiles", "")
            topic = BagTopic(channel.topic, schema.name, schema.data.decode(), qos)
            yield FoundMessage(topic, record.log_time, record.data)


def _decoded(opcode: int, content: bytes) -> Iterator[McapRecord]:
    """The record itself, or the records of a chunk."""
    stream = ReadDataStream(BytesIO(content))
    if opcode == _SCHEMA:
        yield Schema.read(stream)
    elif opcode == _CHANNEL:
        yield Channel.read(stream)
    elif opcode == _MESSAGE:
        yield Message.read(stream, len(content))
    elif opcode == _CHUNK:
        yield from _chunk_records(Chunk.read(stream))


def _chunk_records(chunk: Chunk) -> list[McapRecord]:
    try:
        content = decompress_chunk(chunk.data, chunk.uncompressed_size, chunk.compression)
        return breakup_chunk(replace(chunk, data=content, compression=""), validate_crc=True)
    except DamagedError:
        raise
    except Exception as error:  # a decompressor may raise anything
        raise DamagedError(f"a chunk that cannot be read ({error})") from None
