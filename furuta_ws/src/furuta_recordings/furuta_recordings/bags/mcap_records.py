"""Reads the records of MCAP files, damaged ones too."""

from collections.abc import Iterator
from pathlib import Path

from mcap.records import Channel, Chunk, McapRecord, Message
from mcap.stream_reader import StreamReader, breakup_chunk

from furuta_recordings.bags.bag_files import bag_files

# The encoding of ROS 2, and the names of others.
CDR = "cdr"
ENCODINGS = {
    "json": "JSON",
    "protobuf": "Protobuf",
    "ros1": "ROS 1",
    "flatbuffer": "FlatBuffers",
    "": "unknown",
}


def foreign(channel: Channel) -> str:
    """What the messages of a channel are, if not ROS 2; otherwise empty."""
    encoding = channel.message_encoding
    if encoding == CDR:
        return ""
    return f"messages are {ENCODINGS.get(encoding, repr(encoding))}, not ROS 2"


def foreign_messages(bag: Path) -> str:
    """What the messages of a bag are, if it is an MCAP bag without any of ROS 2."""
    found = []
    for file in bag_files(bag):
        for record in records(file, []) if file.suffix == ".mcap" else ():
            if isinstance(record, Channel):
                found.append(foreign(record))
            elif isinstance(record, Message):  # nearly always after all channels
                break
    return f"its {found[0]}" if found and all(found) else ""


def records(file: Path, problems: list[str]) -> Iterator[McapRecord]:
    """The complete records of a file, those in chunks included; notes what is damaged."""
    with file.open("rb") as stream:
        try:
            for record in StreamReader(stream, emit_chunks=True).records:
                if isinstance(record, Chunk):
                    yield from _inner(record, file, problems)
                else:
                    yield record
        except Exception as error:  # a reader of damaged data may raise anything
            problems.append(f"{file.name}: ends with an incomplete record ({type(error).__name__})")


def _inner(chunk: Chunk, file: Path, problems: list[str]) -> list[McapRecord]:
    try:
        return breakup_chunk(chunk, validate_crc=True)
    except Exception as error:  # a decompressor may raise anything
        problems.append(f"{file.name}: left out a chunk that cannot be read ({error})")
        return []
