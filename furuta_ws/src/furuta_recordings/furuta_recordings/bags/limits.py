"""Limits within which bags are read, and what keeps them in ``rosbags``.

A few kilobytes can stand for gigabytes, and ``rosbags`` and ``mcap`` decompress without a bound. A
megabyte of YAML takes ``rosbags`` half a minute. So it gets the decompressors and the reader of
offered qualities of service of this module. Bags of rosbag2 and of Foxglove's writers stay far
below these limits.
"""

from functools import partial
from typing import Any, Final

import zstandard
from lz4.frame import LZ4FrameDecompressor
from rosbags.interfaces import Qos
from rosbags.rosbag2 import storage_mcap, storage_sqlite3
from rosbags.rosbag2.metadata import parse_qos

from furuta_model.parameters import ParameterError

# Largest chunk of an MCAP file after decompression [bytes], and as a multiple of the compressed
# size; small data may be larger [bytes]. Recordings of a rig shrink to a tenth.
LARGEST_CHUNK: Final = 2**25
LARGEST_EXPANSION: Final = 100
SMALL: Final = 2**16
# Largest description of a message type or topic [bytes], and most topics: 300 bytes of metadata
# each are less than a YAML file may have.
LARGEST_DESCRIPTION: Final = 2**18
MOST_TOPICS: Final = 5000


def decompress_chunk(data: bytes, size: int, compression: str) -> bytes:
    """The content of a chunk that claims a decompressed size of ``size`` [bytes].

    Raises:
        ParameterError: It holds something else, or claims more than it may hold.
    """
    if size > min(LARGEST_CHUNK, max(SMALL, LARGEST_EXPANSION * len(data))):
        raise ParameterError(f"a chunk of {len(data)} bytes that claims to hold {size} bytes")
    if compression == "zstd":
        reader = zstandard.ZstdDecompressor().stream_reader(data, read_across_frames=True)
        content = bytes(reader.read(size + 1))
    elif compression == "lz4":
        content = LZ4FrameDecompressor().decompress(data, max_length=size + 1)
    elif not compression:
        content = data
    else:
        raise ParameterError(f"a chunk with the unknown compression {compression!r}")
    if len(content) != size:
        raise ParameterError(f"a chunk that does not hold the {size} bytes that it claims")
    return content


def parse_offered_qos(dcts: Any) -> list[Qos]:
    """The qualities of service that a topic's publishers offered; an MCAP file has them as YAML."""
    if len(dcts) > LARGEST_DESCRIPTION:
        raise ParameterError(f"a topic described by {len(dcts)} characters of metadata")
    return parse_qos(dcts)


storage_mcap.parse_qos = storage_sqlite3.parse_qos = parse_offered_qos
storage_mcap.DECOMPRESSORS.update(
    {name: partial(decompress_chunk, compression=name) for name in ("", "lz4", "zstd")}
)
