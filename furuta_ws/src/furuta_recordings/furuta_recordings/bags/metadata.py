"""``metadata.yaml`` of a rosbag2 bag as rosbag2 of Jazzy writes it, and names of the files."""

import os
from typing import Any, NamedTuple

import yaml

# The parameters of all nodes at the start of a recording.
PARAMETERS_FILE = "parameters.yaml"
METADATA_FILE = "metadata.yaml"
# Version of the format: that of ROS 2 Jazzy.
VERSION = 9
# What ROS 2 takes for an unlimited duration.
UNLIMITED = {"sec": 9223372036, "nsec": 854775807}


class BagTopic(NamedTuple):
    """A recorded topic.

    ``definition``, its ``encoding`` and ``type_hash`` describe its message type, ``qos`` (YAML) the
    quality of service that its publishers offer.
    """

    name: str
    type_name: str
    definition: str
    qos: str
    type_hash: str = ""
    encoding: str = "ros2msg"


def metadata(
    topics: list[BagTopic], counts: list[int], file: str, times: tuple[int, int]
) -> dict[str, Any]:
    """Content of metadata.yaml of a bag of one file with the first and the last time [ns]."""
    start, end = times
    totals = {
        "duration": {"nanoseconds": max(0, end - start)},
        "starting_time": {"nanoseconds_since_epoch": start},
        "message_count": sum(counts),
    }
    about = {
        "version": VERSION,
        "storage_identifier": "mcap",
        **totals,
        "topics_with_message_count": [
            {"topic_metadata": _topic(topic), "message_count": count}
            for topic, count in zip(topics, counts, strict=True)
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file],
        "files": [{"path": file, **totals}],
        "custom_data": None,
        "ros_distro": os.environ.get("ROS_DISTRO") or "jazzy",
    }
    return {"rosbag2_bagfile_information": about}


def _topic(topic: BagTopic) -> dict[str, Any]:
    return {
        "name": topic.name,
        "type": topic.type_name,
        "serialization_format": "cdr",
        "offered_qos_profiles": yaml.safe_load(topic.qos) or [],
        "type_description_hash": topic.type_hash,
    }


def as_yaml(content: Any) -> str:
    """The content as text, in its order and with equal values written out, as rosbag2 does."""
    return yaml.dump(content, Dumper=_WithoutAliases, sort_keys=False)


class _WithoutAliases(yaml.SafeDumper):
    def ignore_aliases(self, data: Any) -> bool:
        return True


def offered_qos(
    depth: int, durability: str = "volatile", lifespan: dict[str, int] = UNLIMITED
) -> str:
    """YAML of the quality of service that publishers of a reliable topic offer.

    ``depth`` is the length of the queue [messages], ``lifespan`` how long a message is kept
    ({sec, nsec}).
    """
    profile = {
        "history": "keep_last",
        "depth": depth,
        "reliability": "reliable",
        "durability": durability,
        "deadline": UNLIMITED,
        "lifespan": lifespan,
        "liveliness": "automatic",
        "liveliness_lease_duration": UNLIMITED,
        "avoid_ros_namespace_conventions": False,
    }
    return as_yaml([profile]).strip()
