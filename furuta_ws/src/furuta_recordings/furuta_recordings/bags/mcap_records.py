"""Records of the MCAP format that describe a file: its beginning, its filler, its footer."""

from __future__ import annotations

import struct
from typing import NamedTuple

from mcap.data_stream import RecordBuilder
from mcap.records import Channel, Footer, Header, Metadata, MetadataIndex, Schema

MAGIC = b"\x89MCAP0\r\n"
# Opcode and length of a record.
RECORD_HEAD = struct.Struct("<BQ")
# Footer record and the magic bytes after it [bytes].
FOOTER_SIZE = RECORD_HEAD.size + 20 + len(MAGIC)
# Opcode of the record that fills unused space; from 0x80 on, opcodes belong to the application.
FILLER = 0x80


class BagTopic(NamedTuple):
    """A recorded topic.

    ``definition`` and ``type_hash`` describe its message type, ``qos`` (YAML) the quality of
    service that its publishers offer.
    """

    name: str
    type_name: str
    definition: str
    qos: str
    type_hash: str = ""


class FileHead(NamedTuple):
    """What a file begins with (``data``), and the same definitions for its ``summary``."""

    data: bytes
    summary: bytes
    schema_count: int
    metadata_count: int


def file_head(topics: list[BagTopic], metadata: dict[str, dict[str, str]]) -> FileHead:
    """Header, schemas, channels and metadata of a file."""
    builder = RecordBuilder()
    Header(profile="ros2", library="furuta_ws").write(builder)
    data = MAGIC + builder.end()
    definitions = {topic.type_name: topic.definition for topic in reversed(topics)}
    types = list(dict.fromkeys(topic.type_name for topic in topics))
    for number, name in enumerate(types, 1):
        Schema(number, definitions[name].encode(), "ros2msg", name).write(builder)
    for number, topic in enumerate(topics, 1):
        _channel(number, topic, types.index(topic.type_name) + 1).write(builder)
    summary = builder.end()
    data += summary
    for name, content in metadata.items():
        Metadata(name=name, metadata=content).write(builder)
        record = builder.end()
        MetadataIndex(len(data), len(record), name).write(builder)
        summary += builder.end()
        data += record
    return FileHead(data, summary, len(types), len(metadata))


def _channel(number: int, topic: BagTopic, schema: int) -> Channel:
    return Channel(
        id=number,
        topic=topic.name,
        message_encoding="cdr",
        metadata={"offered_qos_profiles": topic.qos, "topic_type_hash": topic.type_hash},
        schema_id=schema,
    )


def filler(length: int) -> bytes:
    """Head of a filler record of ``length`` [bytes] in total, which readers skip."""
    return RECORD_HEAD.pack(FILLER, length - RECORD_HEAD.size)


def footer(summary_start: int) -> bytes:
    """Footer and magic bytes.

    There is no checksum of the summary: footer and checksum would have to change at the same time.
    """
    builder = RecordBuilder()
    Footer(summary_start=summary_start, summary_offset_start=0, summary_crc=0).write(builder)
    return builder.end() + MAGIC
