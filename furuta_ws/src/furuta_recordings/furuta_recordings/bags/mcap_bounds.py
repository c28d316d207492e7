"""Checks the lengths and sizes that an MCAP file claims, before a reader believes them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.records import Chunk, ChunkIndex, Footer, Statistics

from furuta_recordings.bags.bounds import (
    LARGEST_CHUNK,
    LARGEST_DESCRIPTION,
    LARGEST_OVERLAP,
    LARGEST_TOPICS,
    MOST_TOPICS,
    SMALLEST_MESSAGE,
    largest_expanded,
)
from furuta_recordings.bags.damaged_message import DamagedError
from furuta_recordings.bags.decompression import decompress_chunk
from furuta_recordings.bags.mcap_records import FOOTER_SIZE, MAGIC, RECORD_HEAD

_FOOTER, _SCHEMA, _CHANNEL, _CHUNK, _CHUNK_INDEX, _STATISTICS, _DATA_END = 2, 3, 4, 6, 8, 11, 15


def check_mcap(file: Path) -> None:
    """Raise :class:`DamagedError` if the file claims more than it may hold."""
    with file.open("rb") as stream:
        summary = _Content()
        start = _summary_start(stream)
        if start:
            stream.seek(start)
            summary.read(stream)
            summary.check(os.fstat(stream.fileno()).st_size)
        if not summary.is_complete:  # the reader scans the data
            stream.seek(len(MAGIC))
            _Content().read(stream)


class _Content:
    """What a part of a file describes: topics, chunks, statistics."""

    def __init__(self) -> None:
        self.chunks: list[ChunkIndex] = []
        self._schemas = self._channels = self._channel_bytes = 0
        self._has_statistics = False
        self._messages = 0

    @property
    def is_complete(self) -> bool:
        """Whether a reader needs nothing but this part to find topics and messages."""
        return bool(self._schemas) if self._has_statistics else bool(self.chunks)

    def read(self, stream: BinaryIO) -> None:
        """Read records to the end of the part, and into chunks where there are no indexes."""
        for opcode, length in _records(stream):
            if opcode in (_SCHEMA, _CHANNEL):
                self._check_description(opcode, length)
                stream.seek(length, os.SEEK_CUR)
            elif opcode == _CHUNK_INDEX:
                self.chunks.append(ChunkIndex.read(_content(stream, length, LARGEST_DESCRIPTION)))
            elif opcode == _CHUNK:
                chunk = Chunk.read(_content(stream, length, LARGEST_CHUNK + LARGEST_DESCRIPTION))
                size = chunk.uncompressed_size
                self.read(BytesIO(decompress_chunk(chunk.data, size, chunk.compression)))
            elif opcode == _STATISTICS:
                self._has_statistics = True
                content = _content(stream, length, LARGEST_TOPICS)
                self._messages = Statistics.read(content).message_count
            else:
                stream.seek(length, os.SEEK_CUR)

    def check(self, file_size: int) -> None:
        """Check what a summary claims about a file of ``file_size`` [bytes]."""
        _check_chunks(self.chunks, file_size)
        data = max(file_size, sum(chunk.uncompressed_size for chunk in self.chunks))
        if self._messages > data // SMALLEST_MESSAGE:
            raise DamagedError(f"it claims {self._messages} messages, more than it has space for")

    def _check_description(self, opcode: int, length: int) -> None:
        self._schemas += opcode == _SCHEMA
        self._channels += opcode == _CHANNEL
        self._channel_bytes += length if opcode == _CHANNEL else 0
        if length > LARGEST_DESCRIPTION:
            raise DamagedError(f"a topic or type is described by {length} bytes")
        if self._channel_bytes > LARGEST_TOPICS or max(self._schemas, self._channels) > MOST_TOPICS:
            raise DamagedError(f"more than {MOST_TOPICS} topics, or {LARGEST_TOPICS} bytes of them")


def _summary_start(stream: BinaryIO) -> int:
    """Where the summary begins; 0 without one, or if the file ends in another way."""
    size = os.fstat(stream.fileno()).st_size
    if size < len(MAGIC) + FOOTER_SIZE:
        return 0
    stream.seek(size - FOOTER_SIZE + RECORD_HEAD.size)
    start = Footer.read(ReadDataStream(stream)).summary_start
    return start if start < size else 0


def _records(stream: BinaryIO) -> Iterator[tuple[int, int]]:
    """Opcode and length of each record; the stream is at its content."""
    start = stream.tell()
    end = stream.seek(0, os.SEEK_END)
    stream.seek(start)
    while len(head := stream.read(RECORD_HEAD.size)) == RECORD_HEAD.size:
        opcode, length = RECORD_HEAD.unpack(head)
        if opcode in (_FOOTER, _DATA_END):
            return
        if stream.tell() + length > end:
            raise DamagedError(f"a record claims {length} bytes, more than the file has")
        yield opcode, length


def _content(stream: BinaryIO, length: int, largest: int) -> ReadDataStream:
    if length > largest:
        raise DamagedError(f"a record of {length} bytes, at most {largest} are allowed")
    return ReadDataStream(BytesIO(stream.read(length)))


def _check_chunks(chunks: list[ChunkIndex], file_size: int) -> None:
    """Check what the chunks claim to hold, each, together, and at the same time."""
    for chunk in chunks:
        if chunk.uncompressed_size > min(LARGEST_CHUNK, largest_expanded(chunk.compressed_size)):
            raise DamagedError(
                f"a chunk of {chunk.compressed_size} bytes that claims to hold "
                f"{chunk.uncompressed_size} bytes"
            )
    total = sum(chunk.uncompressed_size for chunk in chunks)
    if total > largest_expanded(file_size):
        raise DamagedError(f"chunks that claim to hold {total} bytes in a file of {file_size}")
    overlap = _largest_overlap(chunks)
    if overlap > LARGEST_OVERLAP:
        raise DamagedError(f"{overlap} bytes of chunks with the same times")


def _largest_overlap(chunks: list[ChunkIndex]) -> int:
    """Most bytes of chunks that hold messages of the same time."""
    starts = [(chunk.message_start_time, 1, chunk.uncompressed_size) for chunk in chunks]
    ends = [(chunk.message_end_time, 2, -chunk.uncompressed_size) for chunk in chunks]
    largest = now = 0
    for _, _, change in sorted(starts + ends):
        now += change
        largest = max(largest, now)
    return largest
