"""``metadata.yaml`` of a rosbag2 bag."""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

from furuta_recordings.bags.mcap_file import Kind

VERSION = 5
# Of numbers that change: enough for any time [ns].
WIDTH = 19


class Part(NamedTuple):
    """One file of a bag: name, number of messages, first and last time [ns]."""

    name: str
    messages: int
    start: int
    end: int


def write_metadata(
    bag: Path, kinds: list[Kind], counts: list[int], parts: list[Part], storage: str = "mcap"
) -> None:
    """Bring the bag's metadata.yaml up to date, readable at every moment.

    Numbers have their width, so that a new text of the same length is written over the old one:
    to replace a file by renaming waits for the disk (ext4), which can take seconds.
    """
    text = metadata(kinds, counts, parts, storage).encode()
    file = bag / "metadata.yaml"
    if file.exists() and file.stat().st_size == len(text):
        with file.open("r+b", buffering=0) as there:
            there.write(text)
        return
    new = bag / "metadata.yaml.new"
    new.write_bytes(text)
    new.rename(file)


def metadata(kinds: list[Kind], counts: list[int], parts: list[Part], storage: str) -> str:
    """The text, of version 5, which every ROS 2 since Humble reads."""
    used = [part for part in parts if part.messages]
    start = min((part.start for part in used), default=0)
    end = max((part.end for part in used), default=0)
    lines = [
        "rosbag2_bagfile_information:",
        f"  version: {VERSION}",
        f"  storage_identifier: {storage}",
        f"  duration: {{nanoseconds: {end - start:<{WIDTH}}}}",
        f"  starting_time: {{nanoseconds_since_epoch: {start:<{WIDTH}}}}",
        f"  message_count: {sum(counts):<{WIDTH}}",
        "  topics_with_message_count:" + ("" if kinds else " []"),
    ]
    for kind, count in zip(kinds, counts, strict=True):
        lines += [
            f"    - topic_metadata: {{name: {kind.topic}, type: {kind.type_name}, "
            f"serialization_format: cdr, offered_qos_profiles: {json.dumps(kind.qos)}}}",
            f"      message_count: {count:<{WIDTH}}",
        ]
    lines += ['  compression_format: ""', '  compression_mode: ""', "  relative_file_paths:"]
    lines += [f"    - {json.dumps(part.name)}" for part in parts]
    lines.append("  files:")
    for part in parts:
        span = max(0, part.end - part.start) if part.messages else 0
        first = part.start if part.messages else 0
        lines += [
            f"    - path: {json.dumps(part.name)}",
            f"      starting_time: {{nanoseconds_since_epoch: {first:<{WIDTH}}}}",
            f"      duration: {{nanoseconds: {span:<{WIDTH}}}}",
            f"      message_count: {part.messages:<{WIDTH}}",
        ]
    return "\n".join(lines) + "\n"
