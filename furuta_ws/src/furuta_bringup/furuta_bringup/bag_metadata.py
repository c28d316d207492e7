"""``metadata.yaml`` of a rosbag2 bag."""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

from .mcap_file import Kind

VERSION = 5


class Part(NamedTuple):
    """One file of a bag: name, number of messages, first and last time [ns]."""

    name: str
    messages: int
    start: int
    end: int


def write_metadata(
    bag: Path, kinds: list[Kind], counts: list[int], parts: list[Part], storage: str = "mcap"
) -> None:
    """Replace the bag's metadata.yaml in one go."""
    text = metadata(kinds, counts, parts, storage)
    new = bag / "metadata.yaml.new"
    new.write_text(text)
    new.rename(bag / "metadata.yaml")


def metadata(kinds: list[Kind], counts: list[int], parts: list[Part], storage: str) -> str:
    """The text, of version 5, which every ROS 2 since Humble reads."""
    used = [part for part in parts if part.messages]
    start = min((part.start for part in used), default=0)
    end = max((part.end for part in used), default=0)
    lines = [
        "rosbag2_bagfile_information:",
        f"  version: {VERSION}",
        f"  storage_identifier: {storage}",
        f"  duration: {{nanoseconds: {end - start}}}",
        f"  starting_time: {{nanoseconds_since_epoch: {start}}}",
        f"  message_count: {sum(counts)}",
        "  topics_with_message_count:" + ("" if kinds else " []"),
    ]
    for kind, count in zip(kinds, counts, strict=True):
        lines += [
            f"    - topic_metadata: {{name: {kind.topic}, type: {kind.type_name}, "
            f"serialization_format: cdr, offered_qos_profiles: {json.dumps(kind.qos)}}}",
            f"      message_count: {count}",
        ]
    lines += ['  compression_format: ""', '  compression_mode: ""', "  relative_file_paths:"]
    lines += [f"    - {json.dumps(part.name)}" for part in parts]
    lines.append("  files:")
    for part in parts:
        span = max(0, part.end - part.start) if part.messages else 0
        first = part.start if part.messages else 0
        lines += [
            f"    - path: {json.dumps(part.name)}",
            f"      starting_time: {{nanoseconds_since_epoch: {first}}}",
            f"      duration: {{nanoseconds: {span}}}",
            f"      message_count: {part.messages}",
        ]
    return "\n".join(lines) + "\n"
