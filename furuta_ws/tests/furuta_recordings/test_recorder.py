"""The recorder node: it writes what was published once it is told to collect."""

import json
import os
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from mcap.reader import make_reader
from rclpy.parameter import Parameter
from rosbags.rosbag2 import Reader

from furuta_model.parameters import ParameterError
from furuta_recordings import recorder_node as module
from furuta_recordings.bags.bag import Bag
from furuta_recordings.recorder_node import (
    RECORDABLE,
    RecorderNode,
    chosen_topics,
)
from furuta_ros.testing import joint_state
from furuta_ros.topics import COMMAND, GROUND_TRUTH, MEASUREMENT, Topic

X = (0.1, 0.2, 0.3, 0.4)


def publish(bench: Any, count: int, topics: tuple[Topic, ...] = (MEASUREMENT, COMMAND)) -> None:
    """Publish ``count`` messages on each topic in turn, after its subscriber was discovered."""
    publishers = [bench.publisher(topic) for topic in topics]
    for k in range(count):
        for topic, publisher in zip(topics, publishers, strict=True):
            stamped = topic is MEASUREMENT
            publisher.publish(joint_state(X, k) if stamped else topic.message(data=float(k)))


def read(bag: Path) -> list[tuple[str, int, Any]]:
    with Bag(bag) as opened:
        return [
            (c.topic, time, opened.deserialize(data, c.msgtype))
            for c, time, data in opened.messages()
        ]


def test_messages_stay_in_order(bench: Any, tmp_path: Path) -> None:
    """Topics alternate as published; with ``stamped`` each message has the stamp before it."""
    recorder = RecorderNode(tmp_path / "bag", stamped=True)
    publish(bench, 20)
    recorder.collect()
    recorder.destroy_node()
    got = read(tmp_path / "bag")
    assert [topic for topic, _, _ in got] == ["/measurement", "/command"] * 20
    assert [time for _, time, _ in got] == [k // 2 for k in range(40)]
    assert [m.data for topic, _, m in got if topic == "/command"] == list(range(20))


def test_only_chosen_topics(bench: Any, tmp_path: Path) -> None:
    """No other topic is recorded; closing collects what is left; an unknown one is refused."""
    with pytest.raises(ParameterError, match=f"no topic elbow.*{GROUND_TRUTH.name}"):
        chosen_topics(["elbow"])
    recorder = RecorderNode(tmp_path / "bag", topics=chosen_topics(["/command"]))
    publish(bench, 5, (COMMAND,))
    recorder.destroy_node()
    assert [topic for topic, _, _ in read(tmp_path / "bag")] == ["/command"] * 5


def test_changes_of_parameters_are_recorded(bench: Any, tmp_path: Path) -> None:
    """A change is recorded, a declaration is not."""
    recorder = RecorderNode(tmp_path / "bag")
    bench.probe.declare_parameter("level", 0.1)
    bench.probe.declare_parameter("law", "none")
    changed = [Parameter("level", value=0.2), Parameter("law", value="lugre")]
    bench.probe.set_parameters_atomically(changed)
    bench.spin(lambda: recorder.collect() or recorder.kept)  # type: ignore[func-returns-value]
    recorder.destroy_node()
    ((topic, _, event),) = read(tmp_path / "bag")
    assert (topic, event.node) == ("/parameter_events", "/probe")
    level, law = (each.value for each in event.changed_parameters)
    assert (level.double_value, law.string_value) == (0.2, "lugre")


def test_dropped_messages_are_counted(bench: Any, tmp_path: Path, monkeypatch: Any) -> None:
    """A queue that is too short loses the oldest messages; the recorder counts them."""
    monkeypatch.setattr(module, "RECEIVE_DEPTH", 5)
    recorder = RecorderNode(tmp_path / "bag", topics=[COMMAND])
    publish(bench, 1, (COMMAND,))
    recorder.collect()
    (publisher,) = (p for p in bench.probe.publishers if p.topic_name == "/command")
    for k in range(20):
        publisher.publish(COMMAND.message(data=float(k)))
    recorder.collect()
    assert recorder.lost == 15
    recorder.destroy_node()
    topics = [topic for topic, _, _ in read(tmp_path / "bag")]
    assert topics.count("/command") == 6
    assert topics.count("/rosout") == 1  # its own warning


def test_what_nodes_log_is_recorded(bench: Any, tmp_path: Path) -> None:
    """Also what was logged shortly before the recorder began."""
    bench.probe.get_logger().warning("before")
    recorder = RecorderNode(tmp_path / "bag", topics=[COMMAND])
    bench.probe.get_logger().warning("after")
    bench.spin(lambda: recorder.collect() or recorder.kept >= 2)  # type: ignore[func-returns-value]
    recorder.destroy_node()
    logged = [(topic, log.name, log.msg) for topic, _, log in read(tmp_path / "bag")]
    assert logged == [("/rosout", "probe", "before"), ("/rosout", "probe", "after")]


def installed(path: str) -> Path:
    """A file of the installed ROS, from packages of the system or from wheels."""
    prefixes = [*os.environ["AMENT_PREFIX_PATH"].split(os.pathsep), sys.prefix]
    return next(Path(each) / path for each in prefixes if (Path(each) / path).exists())


def test_type_hashes_are_those_of_the_installed_messages(ros: None, tmp_path: Path) -> None:
    """Metadata and file hold the hashes that the packages of the messages were built with."""
    recorder = RecorderNode(tmp_path / "bag", topics=RECORDABLE)
    recorder.destroy_node()
    content = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())
    topics = content["rosbag2_bagfile_information"]["topics_with_message_count"]
    described = [topic["topic_metadata"] for topic in topics]
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as file:
        channels = make_reader(file).get_summary().channels.values()
    in_file = {channel.topic: channel.metadata["topic_type_hash"] for channel in channels}
    for topic in described:
        package, _, name = topic["type"].partition("/msg/")
        about = json.loads(installed(f"share/{package}/msg/{name}.json").read_text())
        hashes = {each["type_name"]: each["hash_string"] for each in about["type_hashes"]}
        assert topic["type_description_hash"] == in_file[topic["name"]] == hashes[topic["type"]]
    assert {f"/{kind.name}" for kind in RECORDABLE} | {"/rosout"} < in_file.keys()


def test_metadata_is_what_rosbag2_jazzy_writes(bench: Any, tmp_path: Path) -> None:
    """Version 9: policies by name, in a list; rosbags reads the same profiles from both places."""
    recorder = RecorderNode(tmp_path / "bag")
    publish(bench, 3)
    recorder.destroy_node()
    content = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())
    about = content["rosbag2_bagfile_information"]
    assert list(about) == [
        *("version", "storage_identifier", "duration", "starting_time", "message_count"),
        *("topics_with_message_count", "compression_format", "compression_mode"),
        *("relative_file_paths", "files", "custom_data", "ros_distro"),
    ]
    assert (about["version"], about["ros_distro"], about["message_count"]) == (9, "jazzy", 6)
    (profile,) = about["topics_with_message_count"][0]["topic_metadata"]["offered_qos_profiles"]
    assert profile == {
        "history": "keep_last",
        "depth": 10,
        "reliability": "reliable",
        "durability": "volatile",
        "deadline": {"sec": 9223372036, "nsec": 854775807},
        "lifespan": {"sec": 9223372036, "nsec": 854775807},
        "liveliness": "automatic",
        "liveliness_lease_duration": {"sec": 9223372036, "nsec": 854775807},
        "avoid_ros_namespace_conventions": False,
    }
    with Reader(tmp_path / "bag") as bag, Reader(tmp_path / "bag" / "bag_0.mcap") as file:
        assert bag.ros_distro == "jazzy"
        assert {c.topic: c.ext for c in bag.connections} == {
            c.topic: c.ext for c in file.connections
        }
