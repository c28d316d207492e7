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
LARGEST_CHUNK = 2**18
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

    ``counts`` are the numbers of messages by channel, ``times`` the first and the last one [ns]
    in complete chunks, 0 without one.
    """

    def __init__(self, stream: Stream) -> None:
        self._stream = stream
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._indexes = bytearray()  # of the chunks, encoded
        self._chunks = 0
        self._chunk = bytearray()
        # Times and places of the messages in the chunk, one after the other, by channel.
        self._places: defaultdict[int, list[int]] = defaultdict(list)
        self.counts: defaultdict[int, int] = defaultdict(int)
        self.times = 0, 0
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
        self._indexes += _encoded(
            ChunkIndex(end - begin, begin, "", len(data), last, size, offsets, first, len(data))
        )
        if self._chunks:
            first, last = min(first, self.times[0]), max(last, self.times[1])
        self.times = first, last
        self._chunks += 1

    def finish(self) -> None:
        """Write the summary, which readers look for at the end."""
        self.end_chunk()
        self._stream.write(_encoded(DataEnd(0)))
        begin = self._stream.tell()
        statistics = Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=self.counts,
            chunk_count=self._chunks,
            message_count=sum(self.counts.values()),
            message_end_time=self.times[1],
            message_start_time=self.times[0],
            metadata_count=0,
            schema_count=len(self._schemas),
        )
        self._stream.write(_encoded(*self._schemas, *self._channels, statistics))
        self._stream.write(bytes(self._indexes) + _encoded(Footer(begin, 0, 0)) + MCAP0_MAGIC)


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
