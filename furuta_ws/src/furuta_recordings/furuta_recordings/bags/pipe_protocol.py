"""What a recorder sends through the pipe to the process that writes its bag.

The first frame holds topics and parameters as JSON; every other frame holds a message.
"""

import json
import struct
from collections.abc import Iterator

from furuta_recordings.bags.metadata import BagTopic

# Capacity of the pipe [bytes]: a second of the graph at 1 kHz.
PIPE_CAPACITY = 2**20
# The writer's answer once the bag is on the disk; any other line is the reason why it ended.
READY = "ready"
# Length of the data, topic (index), time [ns].
FRAME_HEAD = struct.Struct("<IHQ")


def message_head(topic: int, time: int, data: bytes) -> bytes:
    """What precedes a message's ``data`` in its frame."""
    return FRAME_HEAD.pack(len(data), topic, time)


def header_frame(topics: list[BagTopic], parameters: dict[str, str]) -> bytes:
    """The first frame."""
    data = json.dumps([topics, parameters]).encode()
    return message_head(0, 0, data) + data


def parse_header(data: bytes) -> tuple[list[BagTopic], dict[str, str]]:
    """Topics and parameters from the first frame's data."""
    topics, parameters = json.loads(data)
    return [BagTopic(*topic) for topic in topics], parameters


def complete_frames(data: bytes) -> Iterator[tuple[int, int, bytes, int]]:
    """Topic, time [ns], content and end of every frame that is complete in ``data``."""
    start = 0
    while len(data) - start >= FRAME_HEAD.size:
        length, topic, time = FRAME_HEAD.unpack_from(data, start)
        content = start + FRAME_HEAD.size
        if content + length > len(data):
            return
        start = content + length
        yield topic, time, data[content:start], start
