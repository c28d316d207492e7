"""Decompresses chunks, messages and files of bags, never more than they may hold.

A few kilobytes can stand for gigabytes. ``rosbags`` and ``mcap`` decompress without a bound, so
the table of decompressors in ``rosbags`` gets the ones of this module.
"""

from functools import partial
from pathlib import Path

import zstandard
from lz4.frame import LZ4FrameDecompressor
from rosbags.rosbag2 import storage_mcap

from furuta_recordings.bags.limits import LARGEST_CHUNK, DamagedError, largest_expanded

# Bytes that are decompressed at a time from a compressed file.
_BLOCK = 2**20


def decompress_chunk(data: bytes, size: int, compression: str) -> bytes:
    """The content of a chunk that claims a decompressed size of ``size`` [bytes]."""
    if size > min(LARGEST_CHUNK, largest_expanded(len(data))):
        raise DamagedError(f"a chunk of {len(data)} bytes that claims to hold {size} bytes")
    if compression == "zstd":
        content = _zstd(data, size + 1)
    elif compression == "lz4":
        content = LZ4FrameDecompressor().decompress(data, max_length=size + 1)
    elif not compression:
        content = data
    else:
        raise DamagedError(f"a chunk with the unknown compression {compression!r}")
    if len(content) != size:
        raise DamagedError(f"a chunk that does not hold the {size} bytes that it claims")
    return content


def decompress_message(data: bytes) -> bytes:
    """A message of a bag whose messages are compressed one by one."""
    largest = min(LARGEST_CHUNK, largest_expanded(len(data)))
    content = _zstd(data, largest + 1)
    if len(content) > largest:
        raise DamagedError(f"a message of {len(data)} bytes that holds more than {largest} bytes")
    return content


def decompress_file(file: Path, plain: Path) -> None:
    """Write the content of a compressed file into the new file ``plain``."""
    left = largest_expanded(file.stat().st_size)
    with file.open("rb") as source, plain.open("xb") as target:
        reader = zstandard.ZstdDecompressor().stream_reader(source, read_across_frames=True)
        while block := reader.read(_BLOCK):
            left -= len(block)
            if left < 0:
                raise DamagedError(
                    f"{file.name} holds more than {largest_expanded(file.stat().st_size)} bytes"
                )
            target.write(block)


def _zstd(data: bytes, most: int) -> bytes:
    reader = zstandard.ZstdDecompressor().stream_reader(data, read_across_frames=True)
    return bytes(reader.read(most))


storage_mcap.DECOMPRESSORS.update(
    {name: partial(decompress_chunk, compression=name) for name in ("", "lz4", "zstd")}
)
