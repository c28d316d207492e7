"""Writes ``metadata.yaml`` of a rosbag2 bag; names the files beside its data."""

import json
import os
from functools import cache
from pathlib import Path
from typing import NamedTuple

import yaml

# The parameters of all nodes at the start of a recording.
PARAMETERS_FILE = "parameters.yaml"
METADATA_FILE = "metadata.yaml"
# Version of the format: that of ROS 2 Jazzy.
VERSION = 9
# The distribution whose message definitions are written, unless the environment names another.
DISTRIBUTION = "jazzy"
# Characters reserved for a number that changes: enough for any time [ns].
WIDTH = 19


class BagTopic(NamedTuple):
    """A recorded topic.

    ``definition`` and ``type_hash`` describe its message type, ``qos`` (YAML) the quality of
    service that its publishers offer.
    """

    name: str
    type_name: str
    definition: str
    qos: str
    type_hash: str = ""


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
    lines = information(topics, counts, files).splitlines(keepends=True)
    return "rosbag2_bagfile_information:\n" + "".join(f"  {line}" for line in lines)


def information(topics: list[BagTopic], counts: list[int], files: list[BagFile]) -> str:
    """What rosbag2 knows about a bag; it stores the same text in the file."""
    lines = _totals(counts, files)
    lines.append("topics_with_message_count:" + ("" if topics else " []"))
    for topic, count in zip(topics, counts, strict=True):
        lines += _topic(topic, count)
    names = json.dumps([file.name for file in files])
    lines += ['compression_format: ""', 'compression_mode: ""', f"relative_file_paths: {names}"]
    lines.append("files:" + ("" if files else " []"))
    for file in files:
        lines += _file(file)
    distribution = os.environ.get("ROS_DISTRO") or DISTRIBUTION
    lines += ["custom_data: ~", f"ros_distro: {json.dumps(distribution)}"]
    return "\n".join(lines) + "\n"


def _totals(counts: list[int], files: list[BagFile]) -> list[str]:
    used = [file for file in files if file.messages]
    start = min((file.start for file in used), default=0)
    end = max((file.end for file in used), default=0)
    return [
        f"version: {VERSION}",
        "storage_identifier: sqlite3",
        f"duration: {{nanoseconds: {end - start:<{WIDTH}}}}",
        f"starting_time: {{nanoseconds_since_epoch: {start:<{WIDTH}}}}",
        f"message_count: {sum(counts):<{WIDTH}}",
    ]


def _topic(topic: BagTopic, count: int) -> list[str]:
    return [
        "  - topic_metadata:",
        f"      name: {json.dumps(topic.name)}",
        f"      type: {json.dumps(topic.type_name)}",
        "      serialization_format: cdr",
        f"      offered_qos_profiles: {_profiles(topic.qos)}",
        f"      type_description_hash: {json.dumps(topic.type_hash)}",
        f"    message_count: {count:<{WIDTH}}",
    ]


@cache
def _profiles(qos: str) -> str:
    """The profiles in YAML's flow style, which fits into one line."""
    return json.dumps(yaml.safe_load(qos) or [])


def _file(file: BagFile) -> list[str]:
    start = file.start if file.messages else 0
    duration = max(0, file.end - file.start) if file.messages else 0
    return [
        f"  - path: {json.dumps(file.name)}",
        f"    starting_time: {{nanoseconds_since_epoch: {start:<{WIDTH}}}}",
        f"    duration: {{nanoseconds: {duration:<{WIDTH}}}}",
        f"    message_count: {file.messages:<{WIDTH}}",
    ]
