"""Node ``recorder``: topics into a bag that survives whatever happens to this process."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.mcap_file import Kind
from furuta_recordings.bags.writer_process import BagProcess
from furuta_ros.messages import NANOSECONDS
from furuta_ros.topics import QOS, TIMING, TOPICS, Topic, deep

# Messages of a topic that may wait until they are collected.
RECEIVE_DEPTH = 100_000
# Seconds between two times that who runs the recorder lets it collect.
COLLECT_EVERY = 0.005
PARAMETER_EVENTS = Topic("/parameter_events", ParameterEvent)
PARAMETERS_FILE = "parameters.yaml"
RECORDABLE = (*TOPICS, TIMING)


class RecorderNode(Node):
    """Writes topics as they are, undecoded, to ``path``.

    It belongs to no executor: the middleware keeps what arrives, with its time, until
    :meth:`collect` hands it to a process that writes. So recording costs the loop no callback, and
    no wait for a disk. What was collected is safe, whatever happens to this process. With
    ``stamped``, for lock-step, a message is filed under the newest time stamp before it, which
    makes the bag repeatable, and collecting waits for the writer; otherwise a message is filed
    under the time of its arrival. Where writing fails, on a full disk say, recording ends with a
    message and the graph runs on; the bag holds what came before. ``kept`` and ``lost`` count
    messages handed over and those that the middleware dropped.

    ``parameters`` (a ROS parameter file's text) is kept with the bag, and every change of a
    parameter is recorded from the topic /parameter_events.
    """

    def __init__(
        self,
        path: Path,
        stamped: bool = False,
        topics: Iterable[Topic] = TOPICS,
        parameters: str = "",
    ) -> None:
        super().__init__("recorder", start_parameter_services=False)
        self._stamped = stamped
        self._stamp = 0
        self.failure: str | None = None
        self.kept = self.lost = 0
        chosen = [*topics, PARAMETER_EVENTS]
        kept = {PARAMETERS_FILE: parameters} if parameters else {}
        self._bag = BagProcess(path, [self._kind(topic) for topic in chosen], kept)
        self._sources = [
            self.create_subscription(topic.type, topic.name, _never, deep(RECEIVE_DEPTH), raw=True)
            for topic in chosen
        ]
        self._numbers = [0] * len(chosen)

    def _kind(self, topic: Topic) -> Kind:
        name = _type_name(topic)
        text = get_typestore(Stores.ROS2_JAZZY).generate_msgdef(name, ros_version=2)[0]
        return Kind(self.resolve_topic_name(topic.name), name, text, _QOS)

    def collect(self) -> None:
        """Hand all that has arrived to the process that writes."""
        if self.failure is not None:
            return
        arrived = [each for index in range(len(self._sources)) for each in self._take(index)]
        for time, index, data in sorted(arrived):
            source = self._sources[index]
            if source.msg_type is ParameterEvent and not _changes(data):
                continue
            if source.msg_type is JointState:
                seconds, nanoseconds = struct.unpack_from("<iI", data, 4)
                self._stamp = seconds * NANOSECONDS + nanoseconds
            self._bag.add(index, self._stamp if self._stamped else time, data)
            self.kept += 1
        self._bag.send(wait=self._stamped)
        self._tell_failure()

    def _take(self, index: int) -> Iterator[tuple[int, int, bytes]]:
        """Time of arrival [ns], topic and content of what has arrived on a topic."""
        source = self._sources[index]
        with source.handle:
            while (taken := source.handle.take_message(source.msg_type, True)) is not None:
                data, about = taken
                self._count(source, index, about["publication_sequence_number"])
                yield about["received_timestamp"], index, data

    def _count(self, source: Subscription, index: int, number: int) -> None:
        """Tell of messages that the middleware dropped, by the numbers of the only publisher."""
        missing = number - self._numbers[index] - 1
        if missing > 0 < self._numbers[index] and source.get_publisher_count() == 1:
            self.lost += missing
            self.get_logger().warning(f"{missing} messages on {source.topic} did not arrive")
        self._numbers[index] = number

    def _tell_failure(self) -> None:
        if self.failure is None and self._bag.failure is not None:
            self.failure = self._bag.failure
            self.get_logger().error(f"recording ended: {self.failure}; what came before is kept")

    def close(self) -> None:
        """Collect what is left and finish the bag."""
        self.collect()
        self._bag.close()
        self._tell_failure()

    def destroy_node(self) -> None:
        """Finish the bag with the node."""
        self.close()
        super().destroy_node()


# What makes the recorder of a run once ROS is up.
MakeRecorder = Callable[[], RecorderNode]


def chosen_topics(names: Iterable[str]) -> tuple[Topic, ...]:
    """The topics of these names; all of the graph where none is named."""
    known = {topic.name: topic for topic in RECORDABLE}
    unknown = [name for name in names if name.strip("/") not in known]
    if unknown:
        raise ParameterError(f"no topic {unknown[0]} to record; there are {', '.join(known)}")
    return tuple(known[name.strip("/")] for name in names) or TOPICS


def _changes(data: bytes) -> bool:
    """Whether an event changes parameters; their declaration at a node's start is no change."""
    return bool(deserialize_message(data, ParameterEvent).changed_parameters)


def _never(message: Any) -> None:
    """Callback of subscriptions that no executor serves."""


def _type_name(topic: Any) -> str:
    package, _, _ = topic.type.__module__.partition(".")
    return f"{package}/msg/{topic.type.__name__}"


# As rosbag2 writes a profile: enumerations by number (keep last, reliable, volatile, automatic).
_UNLIMITED = "{sec: 2147483647, nsec: 4294967295}"
_QOS = (
    f"- history: 1\n  depth: {QOS.depth}\n  reliability: 1\n  durability: 2\n"
    f"  deadline: {_UNLIMITED}\n  lifespan: {_UNLIMITED}\n  liveliness: 1\n"
    f"  liveliness_lease_duration: {_UNLIMITED}\n  avoid_ros_namespace_conventions: false"
)
