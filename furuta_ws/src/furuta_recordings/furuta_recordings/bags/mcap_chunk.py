"""A chunk of an MCAP file: messages that are written together, and their indexes."""

from __future__ import annotations

import struct
import zlib
from array import array

from mcap.records import ChunkIndex

_MESSAGE = struct.Struct("<BQHIQQ")
_CHUNK = struct.Struct("<BQQQQIIQ")
_INDEX = struct.Struct("<BQHI")


class PendingChunk:
    """Messages that wait to be written.

    ``size`` [bytes] of their records; ``start`` and ``end`` are the earliest and latest time [ns].
    """

    def __init__(self, topic_count: int) -> None:
        self.size = 0
        self.start, self.end = 2**64 - 1, 0
        self._records: list[bytes] = []
        self._indexes: list[array[int]] = [array("Q") for _ in range(topic_count)]

    def add(self, topic: int, sequence: int, time: int, data: bytes) -> None:
        """Add the message number ``sequence`` of a topic (index), received at ``time`` [ns]."""
        head = _MESSAGE.pack(5, 22 + len(data), topic + 1, sequence, time, time)
        index = self._indexes[topic]
        index.append(time)
        index.append(self.size)
        self._records += (head, data)
        self.size += len(head) + len(data)
        self.start = min(self.start, time)
        self.end = max(self.end, time)

    def encoded(self, offset: int) -> tuple[bytes, ChunkIndex]:
        """Chunk and message indexes for writing at ``offset`` [bytes]; the summary's entry."""
        data = b"".join(self._records)
        size, checksum = len(data), zlib.crc32(data)
        head = _CHUNK.pack(6, 40 + size, self.start, self.end, size, checksum, 0, size)
        chunk = head + data
        indexes, offsets = self._message_indexes(offset + len(chunk))
        entry = ChunkIndex(
            chunk_length=len(chunk),
            chunk_start_offset=offset,
            compression="",
            compressed_size=size,
            message_end_time=self.end,
            message_index_length=len(indexes),
            message_index_offsets=offsets,
            message_start_time=self.start,
            uncompressed_size=size,
        )
        return chunk + indexes, entry

    def _message_indexes(self, offset: int) -> tuple[bytes, dict[int, int]]:
        """One index record per topic with messages, and the place of each by channel number."""
        records, offsets = b"", {}
        for channel, index in enumerate(self._indexes, 1):
            if index:
                entries = index.tobytes()
                offsets[channel] = offset + len(records)
                records += _INDEX.pack(7, 6 + len(entries), channel, len(entries)) + entries
        return records, offsets
