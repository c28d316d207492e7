"""An MCAP file that is complete at every moment, whatever becomes of the process that writes it.

An MCAP file ends with a summary and a footer; a writer that is killed before its end leaves a
file that readers refuse. Here summary and footer are there from the start, behind room for data
that takes no disk space until it is filled (a sparse file):

    header | chunks …  (room) | summary A | summary B | footer

A turn writes a chunk into the room and a new summary over the one not in use; nothing of that
counts until the footer, 20 bytes in one block, is pointed at the new summary. Records of a kind
of our own, which readers skip as the format says, span the room and what lies between a summary
and the footer. ``close`` puts summary and footer behind the last chunk and cuts the rest off,
which leaves an ordinary file.
"""

from __future__ import annotations

import os
import struct
import zlib
from array import array
from pathlib import Path
from typing import NamedTuple

from mcap.data_stream import RecordBuilder
from mcap.records import (
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)

MAGIC = b"\x89MCAP0\r\n"
# Room for data and for a summary [bytes]; a file that has filled either is followed by another.
DATA_ROOM = 64 * 2**20
SUMMARY_ROOM = 2**20
# Footer record and the magic behind it [bytes].
FOOTER = 9 + 20 + len(MAGIC)
# Opcode of the record that fills a gap; from 0x80 on they are the application's own.
GAP = 0x80
_HEAD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<BQHIQQ")
_CHUNK = struct.Struct("<BQQQQIIQ")
_INDEX = struct.Struct("<BQHI")


class Kind(NamedTuple):
    """A topic with its type and the definition that goes into the file."""

    topic: str
    type_name: str
    definition: str
    qos: str


class McapFile:
    """Takes messages (:meth:`add`) and makes them last (:meth:`flush`)."""

    def __init__(self, path: Path, kinds: list[Kind], metadata: dict[str, dict[str, str]]) -> None:
        self.path = path
        self.counts = [0] * len(kinds)
        self.start, self.end = 2**63 - 1, 0
        self._records: list[bytes] = []
        self.waiting = 0
        self._index: list[array[int]] = [array("Q") for _ in kinds]
        self._chunk_times = [2**64 - 1, 0]
        self._chunk_indexes = RecordBuilder()
        self._index_bytes = b""
        self._chunks = 0
        self._turn = 0
        self._data_end = 0
        part = path.with_name(path.name + ".new")
        self._file = os.open(part, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o644)
        self._describe(kinds, metadata)
        os.ftruncate(self._file, DATA_ROOM + 2 * SUMMARY_ROOM + FOOTER)
        self._summarise()
        os.rename(part, path)

    @property
    def full(self) -> bool:
        """Whether there is room for no more than what is already waiting."""
        return (
            self._data_end + 2 * self.waiting + 2**20 > DATA_ROOM
            or len(self._index_bytes) > SUMMARY_ROOM // 2
        )

    def add(self, channel: int, time: int, data: bytes) -> None:
        """Keep a message of channel ``channel`` (index into the kinds) until the next flush."""
        head = _MESSAGE.pack(5, 22 + len(data), channel + 1, self.counts[channel], time, time)
        index = self._index[channel]
        index.append(time)
        index.append(self.waiting)
        self._records += (head, data)
        self.waiting += len(head) + len(data)
        self.counts[channel] += 1
        times = self._chunk_times
        times[0] = min(times[0], time)
        times[1] = max(times[1], time)

    def flush(self) -> None:
        """Write what was added; raises :class:`OSError` where that cannot be, the file intact."""
        if not self._records:
            return
        data = b"".join(self._records)
        first, last = self._chunk_times
        chunk = _CHUNK.pack(
            6, 40 + len(data), first, last, len(data), zlib.crc32(data), 0, len(data)
        )
        start = self._data_end
        length = len(chunk) + len(data)
        offsets, indexes = {}, []
        position = start + length
        for channel, index in enumerate(self._index):
            if index:
                entries = index.tobytes()
                offsets[channel + 1] = position
                indexes += [_INDEX.pack(7, 6 + len(entries), channel + 1, len(entries)), entries]
                position += 15 + len(entries)
        self._write(start, b"".join((chunk, data, *indexes, _gap(position))))
        self._data_end = position
        ChunkIndex(
            chunk_length=length,
            chunk_start_offset=start,
            compression="",
            compressed_size=len(data),
            message_end_time=last,
            message_index_length=position - start - length,
            message_index_offsets=offsets,
            message_start_time=first,
            uncompressed_size=len(data),
        ).write(self._chunk_indexes)
        self._index_bytes += self._chunk_indexes.end()
        self._chunks += 1
        self.start, self.end = min(self.start, first), max(self.end, last)
        self._records, self.waiting = [], 0
        self._index = [array("Q") for _ in self._index]
        self._chunk_times = [2**64 - 1, 0]
        self._summarise()

    def close(self) -> None:
        """Write what is left and make an ordinary file; the room that was not used goes."""
        try:
            self.flush()
            builder = RecordBuilder()
            DataEnd(0).write(builder)
            end = builder.end()
            summary = self._summary()
            at = self._data_end + len(end)
            self._write(self._data_end, end + summary + _footer(at))
            os.ftruncate(self._file, at + len(summary) + FOOTER)
        finally:
            os.close(self._file)

    def _describe(self, kinds: list[Kind], metadata: dict[str, dict[str, str]]) -> None:
        """Header, schemas, channels and metadata, which are also what a summary begins with."""
        builder = RecordBuilder()
        Header(profile="ros2", library="furuta_ws").write(builder)
        start = MAGIC + builder.end()
        names = list(dict.fromkeys(kind.type_name for kind in kinds))
        for number, name in enumerate(names, 1):
            text = next(kind.definition for kind in kinds if kind.type_name == name)
            Schema(number, text.encode(), "ros2msg", name).write(builder)
        for number, kind in enumerate(kinds, 1):
            Channel(
                id=number,
                topic=kind.topic,
                message_encoding="cdr",
                metadata={"offered_qos_profiles": kind.qos},
                schema_id=names.index(kind.type_name) + 1,
            ).write(builder)
        self._described = builder.end()
        self._schemas = len(names)
        start += self._described
        for name, content in metadata.items():
            Metadata(name=name, metadata=content).write(builder)
            record = builder.end()
            MetadataIndex(len(start), len(record), name).write(builder)
            self._described += builder.end()
            start += record
        self._metadata = len(metadata)
        self._data_end = len(start)
        self._write(0, start + _gap(len(start)))

    def _summary(self) -> bytes:
        builder = RecordBuilder()
        empty = not self._chunks
        Statistics(
            attachment_count=0,
            channel_count=len(self.counts),
            channel_message_counts={k + 1: n for k, n in enumerate(self.counts) if n},
            chunk_count=self._chunks,
            message_count=sum(self.counts),
            message_end_time=self.end,
            message_start_time=0 if empty else self.start,
            metadata_count=self._metadata,
            schema_count=self._schemas,
        ).write(builder)
        return self._described + builder.end() + self._index_bytes

    def _summarise(self) -> None:
        """Write a summary over the one not in use, then turn the footer to it."""
        at = DATA_ROOM + (self._turn % 2) * SUMMARY_ROOM
        self._turn += 1
        summary = self._summary()
        footer = DATA_ROOM + 2 * SUMMARY_ROOM
        gap = footer - at - len(summary) - _HEAD.size
        self._write(at, summary + _HEAD.pack(GAP, gap))
        self._write(footer, _footer(at))

    def _write(self, at: int, data: bytes) -> None:
        view = memoryview(data)
        while view:
            written = os.pwrite(self._file, view, at)
            view, at = view[written:], at + written


def _gap(start: int) -> bytes:
    """Head of the record that fills the room from ``start`` to the summaries."""
    return _HEAD.pack(GAP, DATA_ROOM - start - _HEAD.size)


def _footer(summary: int) -> bytes:
    """Footer and magic; without a checksum, which would have to change with it in one go."""
    builder = RecordBuilder()
    Footer(summary_start=summary, summary_offset_start=0, summary_crc=0).write(builder)
    return builder.end() + MAGIC
