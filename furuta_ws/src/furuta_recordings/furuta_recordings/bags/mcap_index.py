"""Finds messages in an MCAP file by its indexes, and reads only those that are wanted.

The readers of ``rosbags`` and ``mcap`` decode every message of each chunk in which one is wanted.
"""

from __future__ import annotations

import zlib
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.reader import make_reader
from mcap.records import Chunk, ChunkIndex
from mcap.summary import Summary

from furuta_recordings.bags.bounds import (
    LARGEST_CHUNK,
    LARGEST_DESCRIPTION,
    SMALLEST_MESSAGE,
)
from furuta_recordings.bags.damaged_message import DamagedError
from furuta_recordings.bags.decompression import decompress_chunk
from furuta_recordings.bags.mcap_records import RECORD_HEAD

# Chunks that stay in memory: the topics of a graph share them.
KEPT_CHUNKS = 4
_MESSAGE_HEAD = 22  # [bytes] of a message record before its data
_MESSAGE, _MESSAGE_INDEX = 5, 7
_INDEX_HEAD = 6  # [bytes] of a message index before its entries
_ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
# Time [ns] of a message, its chunk (index) and its offset there [bytes].
PLACE = np.dtype([("time", "<i8"), ("chunk", "<i8"), ("offset", "<i8")])


class McapIndex:
    """The indexes of an MCAP file that :func:`check_mcap` has accepted, to be closed."""

    def __init__(self, file: Path) -> None:
        self._file: BinaryIO = file.open("rb")
        found = make_reader(self._file).get_summary() or Summary()
        self._chunks: list[ChunkIndex] = found.chunk_indexes
        self._channels = found.channels
        self._types = {number: each.name for number, each in found.schemas.items()}
        self._content = lru_cache(KEPT_CHUNKS)(self._read_chunk)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    @property
    def is_complete(self) -> bool:
        """Whether each message is in an index."""
        return bool(self._chunks) and all(each.message_index_offsets for each in self._chunks)

    def find(self, topic: str, type_name: str, first: int, last: int) -> np.ndarray:
        """The places (n,), of type ``PLACE``, of messages with ``first`` <= time < ``last`` [ns].

        Raises:
            DamagedError: An index is not what the file claims.
        """
        wanted = [
            number
            for number, each in self._channels.items()
            if each.topic == topic and self._types.get(each.schema_id) == type_name
        ]
        found = [np.zeros(0, PLACE)]
        for number, chunk in enumerate(self._chunks):
            if chunk.message_start_time < last and chunk.message_end_time >= first:
                for channel in wanted:
                    entries = self._entries(chunk, channel)
                    entries = entries[(entries["time"] >= first) & (entries["time"] < last)]
                    places = np.zeros(len(entries), PLACE)
                    places["time"], places["offset"] = entries["time"], entries["offset"]
                    places["chunk"] = number
                    found.append(places)
        return np.concatenate(found)

    def read(self, chunk: int, offset: int) -> bytes:
        """The serialized message at a place."""
        content = self._content(chunk)
        start = offset + RECORD_HEAD.size
        if not RECORD_HEAD.size <= start <= len(content):
            raise DamagedError("a message outside of its chunk")
        opcode, length = RECORD_HEAD.unpack_from(content, offset)
        if opcode != _MESSAGE or length < _MESSAGE_HEAD or start + length > len(content):
            raise DamagedError("an index that points to no message")
        return content[start + _MESSAGE_HEAD : start + length]

    def _entries(self, chunk: ChunkIndex, channel: int) -> np.ndarray:
        """The entries of a channel's message index; none if the chunk has no such message."""
        offset = chunk.message_index_offsets.get(channel)
        if offset is None:
            return np.zeros(0, _ENTRY)
        self._file.seek(offset)
        opcode, length = RECORD_HEAD.unpack(self._exactly(RECORD_HEAD.size))
        most = chunk.uncompressed_size // SMALLEST_MESSAGE * _ENTRY.itemsize
        if opcode != _MESSAGE_INDEX or not _INDEX_HEAD <= length <= most + _INDEX_HEAD:
            raise DamagedError("a chunk without the index that it claims")
        entries = self._exactly(length)[_INDEX_HEAD:]
        return np.frombuffer(entries, _ENTRY, len(entries) // _ENTRY.itemsize)

    def _read_chunk(self, number: int) -> bytes:
        index = self._chunks[number]
        self._file.seek(index.chunk_start_offset + RECORD_HEAD.size)
        record = self._exactly(index.chunk_length - RECORD_HEAD.size)
        chunk = Chunk.read(ReadDataStream(BytesIO(record)))
        content = decompress_chunk(chunk.data, chunk.uncompressed_size, chunk.compression)
        if chunk.uncompressed_crc and zlib.crc32(content) != chunk.uncompressed_crc:
            raise DamagedError("a chunk with a wrong checksum")
        return content

    def _exactly(self, size: int) -> bytes:
        if not 0 <= size <= LARGEST_CHUNK + LARGEST_DESCRIPTION:
            raise DamagedError(f"a record of {size} bytes")
        data = self._file.read(size)
        if len(data) != size:
            raise DamagedError("a record beyond the end of the file")
        return data
