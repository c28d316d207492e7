"""What is left of a broken bag, read record by record up to where it breaks."""

from __future__ import annotations

import sqlite3
import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, NamedTuple

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.records import Channel, Chunk, Message, Schema
from rosbags.typesys import Stores, get_typestore

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


class Broken(Exception):
    """Here the sound part of a file ends, with the reason in words."""


def recover(bag: Path, out: Path) -> dict[str, object]:
    """Write what can be read of ``bag`` (directory or file) into a new bag ``out``."""
    files = sorted(
        file
        for file in ([bag] if bag.is_file() else bag.iterdir() if bag.is_dir() else [])
        if file.suffix in (".mcap", ".db3")
    )
    if not files:
        raise ParameterError(f"{bag} holds no .mcap and no .db3 file: nothing to recover")
    if out.exists():
        raise ParameterError(f"{out} exists already; name another directory for the bag")
    reasons: list[str] = []
    kinds = _kinds(files)
    if not kinds:
        raise ParameterError(f"{bag} holds nothing that can be read as a bag")
    kept = bag / PARAMETERS_FILE
    parameters = {PARAMETERS_FILE: kept.read_text()} if kept.is_file() else {}
    writer = BagWriter(out, kinds, parameters)
    place = {(kind.topic, kind.type_name): index for index, kind in enumerate(kinds)}
    messages = waiting = 0
    for found in _messages(files, reasons):
        writer.add(place[found.kind.topic, found.kind.type_name], found.time, found.data)
        messages += 1
        waiting += len(found.data)
        if waiting > 2**20:
            writer.flush()
            waiting = 0
    writer.close()
    return {"bag": str(out), "messages": messages, "ended_by": reasons}


def _kinds(files: list[Path]) -> list[Kind]:
    """Topics of all messages, in the order of their first ones."""
    kinds: dict[tuple[str, str], Kind] = {}
    for found in _messages(files, []):
        kinds.setdefault((found.kind.topic, found.kind.type_name), found.kind)
    return list(kinds.values())


def _messages(files: list[Path], reasons: list[str]) -> Iterator[Found]:
    for file in files:
        try:
            yield from _of_sqlite(file) if file.suffix == ".db3" else _of_mcap(file)
        except (Broken, OSError, sqlite3.Error) as error:
            reasons.append(f"{file.name}: {error}")


def _of_sqlite(file: Path) -> Iterator[Found]:
    types = get_typestore(Stores.ROS2_JAZZY)
    connection = sqlite3.connect(f"file:{file}?mode=ro", uri=True)
    try:
        kinds = {}
        for number, topic, name in connection.execute("SELECT id, name, type FROM topics"):
            known = name in types.types
            text = types.generate_msgdef(name, ros_version=2)[0] if known else ""
            kinds[number] = Kind(topic, name, text, "")
        for number, time, data in connection.execute(
            "SELECT topic_id, timestamp, data FROM messages ORDER BY id"
        ):
            if number in kinds:
                yield Found(kinds[number], time, data)
    finally:
        connection.close()


def _of_mcap(file: Path) -> Iterator[Found]:
    with file.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise Broken("no MCAP file")
        yield from _of_records(stream, {}, {})


def _of_records(
    stream: BinaryIO, schemas: dict[int, Schema], channels: dict[int, Channel]
) -> Iterator[Found]:
    """Messages of the records of a file or of a chunk, until there is no more or one is broken."""
    while True:
        head = stream.read(_HEAD.size)
        if not head:
            return
        if len(head) < _HEAD.size:
            raise Broken("ends within a record")
        opcode, length = _HEAD.unpack(head)
        if opcode in (0, _DATA_END):
            return
        if length > LONGEST_RECORD:
            if opcode >= 0x80:
                return
            raise Broken(f"a record that claims {length} bytes")
        content = stream.read(length)
        if len(content) < length:
            raise Broken("ends within a record")
        try:
            yield from _of_record(opcode, content, schemas, channels)
        except (struct.error, ValueError, KeyError, UnicodeDecodeError, EOFError) as error:
            raise Broken(f"a malformed record ({type(error).__name__})") from None


def _of_record(
    opcode: int, content: bytes, schemas: dict[int, Schema], channels: dict[int, Channel]
) -> Iterator[Found]:
    stream = ReadDataStream(BytesIO(content))
    if opcode == _SCHEMA:
        schema = Schema.read(stream)
        schemas[schema.id] = schema
    elif opcode == _CHANNEL:
        channel = Channel.read(stream)
        channels[channel.id] = channel
    elif opcode == _MESSAGE:
        message = Message.read(stream, len(content))
        channel = channels[message.channel_id]
        schema = schemas[channel.schema_id]
        qos = channel.metadata.get("offered_qos_profiles", "")
        kind = Kind(channel.topic, schema.name, schema.data.decode(), qos)
        yield Found(kind, message.log_time, message.data)
    elif opcode == _CHUNK:
        chunk = Chunk.read(stream)
        yield from _of_records(BytesIO(_unpacked(chunk)), schemas, channels)


def _unpacked(chunk: Chunk) -> bytes:
    """A chunk's records; :class:`Broken` where its checksum says they are not what was written."""
    if chunk.uncompressed_size > LONGEST_RECORD:
        raise Broken(f"a chunk that claims {chunk.uncompressed_size} bytes")
    try:
        if chunk.compression == "zstd":
            data = zstandard.decompress(chunk.data, max_output_size=chunk.uncompressed_size)
        elif chunk.compression == "lz4":
            data = lz4.frame.decompress(chunk.data)
        else:
            data = chunk.data
    except (zstandard.ZstdError, RuntimeError) as error:
        raise Broken(f"a chunk that cannot be unpacked ({error})") from None
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise Broken("a chunk whose checksum is wrong")
    return data
