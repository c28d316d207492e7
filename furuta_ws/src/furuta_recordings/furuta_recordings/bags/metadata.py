"""Writes ``metadata.yaml`` of a rosbag2 bag; names the files beside its data."""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

from furuta_recordings.bags.mcap_records import BagTopic

# The parameters of all nodes at the start of a recording.
PARAMETERS_FILE = "parameters.yaml"
METADATA_FILE = "metadata.yaml"
# Version of the format, which every ROS 2 since Humble reads.
VERSION = 5
# Characters reserved for a number that changes: enough for any time [ns].
WIDTH = 19


class BagFile(NamedTuple):
    """One data file of a bag: name, number of messages, first and last time [ns]."""

    name: str
    messages: int
    start: int
    end: int


def write_metadata(
    bag: Path, topics: list[BagTopic], counts: list[int], files: list[BagFile]
) -> None:
    """Update the bag's metadata.yaml, which stays readable at every moment.

    Numbers have a fixed width, so that a new text of the same length is written over the old one.
    Replacing the file by renaming would wait for the disk (ext4), which can take seconds.
    """
    text = metadata(topics, counts, files).encode()
    file = bag / METADATA_FILE
    if file.exists() and file.stat().st_size == len(text):
        with file.open("r+b", buffering=0) as stream:
            stream.write(text)
        return
    new = bag / f"{METADATA_FILE}.new"
    new.write_bytes(text)
    new.rename(file)


def metadata(topics: list[BagTopic], counts: list[int], files: list[BagFile]) -> str:
    """Content of metadata.yaml."""
    lines = _totals(counts, files)
    lines.append("  topics_with_message_count:" + ("" if topics else " []"))
    for topic, count in zip(topics, counts, strict=True):
        lines += _topic(topic, count)
    lines += ['  compression_format: ""', '  compression_mode: ""', "  relative_file_paths:"]
    lines += [f"    - {json.dumps(file.name)}" for file in files]
    lines.append("  files:")
    for file in files:
        lines += _file(file)
    return "\n".join(lines) + "\n"


def _totals(counts: list[int], files: list[BagFile]) -> list[str]:
    used = [file for file in files if file.messages]
    start = min((file.start for file in used), default=0)
    end = max((file.end for file in used), default=0)
    return [
        "rosbag2_bagfile_information:",
        f"  version: {VERSION}",
        "  storage_identifier: mcap",
        f"  duration: {{nanoseconds: {end - start:<{WIDTH}}}}",
        f"  starting_time: {{nanoseconds_since_epoch: {start:<{WIDTH}}}}",
        f"  message_count: {sum(counts):<{WIDTH}}",
    ]


def _topic(topic: BagTopic, count: int) -> list[str]:
    return [
        f"    - topic_metadata: {{name: {topic.name}, type: {topic.type_name}, "
        f"serialization_format: cdr, offered_qos_profiles: {json.dumps(topic.qos)}}}",
        f"      message_count: {count:<{WIDTH}}",
    ]


def _file(file: BagFile) -> list[str]:
    start = file.start if file.messages else 0
    duration = max(0, file.end - file.start) if file.messages else 0
    return [
        f"    - path: {json.dumps(file.name)}",
        f"      starting_time: {{nanoseconds_since_epoch: {start:<{WIDTH}}}}",
        f"      duration: {{nanoseconds: {duration:<{WIDTH}}}}",
        f"      message_count: {file.messages:<{WIDTH}}",
    ]
