"""Writes an MCAP file in chunks: a message takes a microsecond, a fifth of the library's writer.

The records are those of the library; only messages and their indexes are encoded here.
"""

from collections import defaultdict
from struct import Struct, pack
from typing import Protocol
from zlib import crc32

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Schema,
    Statistics,
)
from mcap.writer import LIBRARY_IDENTIFIER, MCAP0_MAGIC

# Largest chunk [bytes], but for its last message.
LARGEST_CHUNK = 2**16
# Opcode, length, channel, sequence number, and two times.
_MESSAGE = Struct("<BQHIQQ")
_HEAD = 22  # bytes of a message before its data


class Stream(Protocol):
    """What a file is written to."""

    def write(self, data: bytes) -> object:
        """Take data."""

    def tell(self) -> int:
        """The number of bytes so far."""


class McapFile:
    """Topics and messages of an MCAP file with the profile ros2.

    ``counts`` are the numbers of messages by channel, ``times`` the first and the last one [ns].
    """

    def __init__(self, stream: Stream) -> None:
        self._stream = stream
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._indexes: list[ChunkIndex] = []
        self._chunk = bytearray()
        # Times and places of the messages in the chunk, one after the other, by channel.
        self._places: defaultdict[int, list[int]] = defaultdict(list)
        self.counts: defaultdict[int, int] = defaultdict(int)
        stream.write(MCAP0_MAGIC + _encoded(Header("ros2", LIBRARY_IDENTIFIER)))

    def add_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Add the definition of a message type; returns its number."""
        self._schemas.append(Schema(len(self._schemas) + 1, data, encoding, name))
        self._stream.write(_encoded(self._schemas[-1]))
        return len(self._schemas)

    def add_channel(self, topic: str, schema: int, about: dict[str, str]) -> int:
        """Add a topic with messages in CDR; returns its number."""
        self._channels.append(Channel(len(self._channels) + 1, topic, "cdr", about, schema))
        self._stream.write(_encoded(self._channels[-1]))
        return len(self._channels)

    def add(self, channel: int, time: int, data: bytes) -> None:
        """Add a message received at ``time`` [ns]."""
        self._places[channel] += time, len(self._chunk)
        self._chunk += _MESSAGE.pack(Opcode.MESSAGE, _HEAD + len(data), channel, 0, time, time)
        self._chunk += data
        if len(self._chunk) > LARGEST_CHUNK:
            self.end_chunk()

    def end_chunk(self) -> None:
        """Write the messages so far as a chunk with its indexes."""
        if not self._chunk:
            return
        data, self._chunk = bytes(self._chunk), bytearray()
        places, self._places = self._places, defaultdict(list)
        times = [time for each in places.values() for time in each[::2]]
        first, last = min(times), max(times)
        begin = self._stream.tell()
        self._stream.write(_encoded(Chunk("", data, last, first, crc32(data), len(data))))
        end, offsets = self._stream.tell(), {}
        for channel, each in places.items():
            self.counts[channel] += len(each) // 2
            offsets[channel] = self._stream.tell()
            self._stream.write(_message_index(channel, each))
        size = self._stream.tell() - end
        self._indexes.append(
            ChunkIndex(end - begin, begin, "", len(data), last, size, offsets, first, len(data))
        )

    @property
    def times(self) -> tuple[int, int]:
        """First and last time of a message [ns]; 0 without one."""
        first = min((index.message_start_time for index in self._indexes), default=0)
        return first, max((index.message_end_time for index in self._indexes), default=0)

    def finish(self) -> None:
        """Write the summary, which readers look for at the end."""
        self.end_chunk()
        self._stream.write(_encoded(DataEnd(0)))
        begin = self._stream.tell()
        first, last = self.times
        statistics = Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=self.counts,
            chunk_count=len(self._indexes),
            message_count=sum(self.counts.values()),
            message_end_time=last,
            message_start_time=first,
            metadata_count=0,
            schema_count=len(self._schemas),
        )
        records = (*self._schemas, *self._channels, *self._indexes, statistics)
        self._stream.write(_encoded(*records, Footer(begin, 0, 0)) + MCAP0_MAGIC)


def _encoded(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())


def _message_index(channel: int, places: list[int]) -> bytes:
    """The record that lists times and places of a channel's messages in a chunk."""
    size = 8 * len(places)
    head = pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + size, channel, size)
    return head + pack(f"<{len(places)}Q", *places)
