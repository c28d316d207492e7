"""The recorder node: it writes what was published once it is told to collect."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from rclpy.parameter import Parameter
from testbench import joint_state

from furuta_model.parameters import ParameterError
from furuta_recordings import recorder_node as module
from furuta_recordings.bags.bag import Bag
from furuta_recordings.recorder_node import RecorderNode, chosen_topics
from furuta_ros.topics import COMMAND, GROUND_TRUTH, MEASUREMENT, TIMING, TOPICS, Topic

X = (0.1, 0.2, 0.3, 0.4)


def publish(bench: Any, count: int, topics: tuple[Topic, ...] = (MEASUREMENT, COMMAND)) -> None:
    """Publish ``count`` messages on each topic in turn, after its subscriber was discovered."""
    publishers = [bench.publisher(topic) for topic in topics]
    for k in range(count):
        for topic, publisher in zip(topics, publishers, strict=True):
            stamped = topic is MEASUREMENT
            publisher.publish(joint_state(X, k) if stamped else topic.type(data=float(k)))


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
    """No other topic is recorded; closing collects what is left."""
    recorder = RecorderNode(tmp_path / "bag", topics=chosen_topics(["/command"]))
    publish(bench, 5, (COMMAND,))
    recorder.destroy_node()
    assert [topic for topic, _, _ in read(tmp_path / "bag")] == ["/command"] * 5


def test_topics_by_name() -> None:
    """Without names those of the graph; for an unknown one the message lists all."""
    assert chosen_topics([]) == TOPICS
    assert chosen_topics(["timing", "ground_truth"]) == (TIMING, GROUND_TRUTH)
    with pytest.raises(ParameterError, match=f"no topic elbow.*{GROUND_TRUTH.name}"):
        chosen_topics(["elbow"])


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
        publisher.publish(COMMAND.type(data=float(k)))
    recorder.collect()
    assert recorder.lost == 15
    recorder.destroy_node()
    assert len(read(tmp_path / "bag")) == 6
