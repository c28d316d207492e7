"""Node ``recorder``: writes topics into a bag that survives the end of this process."""

import struct
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.metadata import PARAMETERS_FILE, BagTopic, offered_qos
from furuta_recordings.bags.writer import BagWriter
from furuta_ros.errors import UserError
from furuta_ros.messages import RefusedError, deserialized
from furuta_ros.node import QOS, deep
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import ACTIVE_MODE, PARAMETER_EVENTS, ROSOUT, TIMING, TOPICS, Topic

# Most messages of a topic that may wait for :meth:`RecorderNode.collect`.
RECEIVE_DEPTH = 100_000
# Time [s] between two calls of :meth:`RecorderNode.collect` by whoever runs the recorder.
COLLECT_EVERY = 0.005
# What is offered on these: rcl keeps a log message for 10 s for late subscribers.
_OFFERED = {
    PARAMETER_EVENTS: offered_qos(depth=1000),
    ROSOUT: offered_qos(1000, "transient_local", lifespan={"sec": 10, "nsec": 0}),
    ACTIVE_MODE: offered_qos(QOS.depth, "transient_local"),
}
RECORDABLE = (*TOPICS, TIMING)
# Seconds and nanoseconds of the stamp in a serialized JointState, after the four bytes that name
# the encoding.
_STAMP, _STAMP_OFFSET = struct.Struct("<iI"), 4


class RecorderNode(Node):
    """Writes serialized messages to the bag ``path``.

    The node belongs to no executor. The middleware keeps received messages with their times until
    :meth:`collect` adds them to the bag, which a thread writes. Recording therefore costs the
    control loop no callback and no wait for a disk.

    By default a message gets the time of its arrival. With ``stamped``, for lock-step, it gets the
    newest time stamp before it, which makes the bag repeatable, and :meth:`collect` waits for a
    slow disk. If writing fails, for example on a full disk, recording ends with an error message,
    the graph continues, and ``furuta bag recover`` copies what was written. ``kept`` and ``lost``
    count the messages that were passed on and those that the middleware dropped.

    ``parameters`` (text of a ROS parameter file) is stored with the bag. Besides ``topics`` it
    records each change of a parameter (/parameter_events), what the nodes log (/rosout), and what
    the controller does (active_mode).
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
        self._newest_stamp = 0
        self.failure: str | None = None
        self.kept = self.lost = 0
        chosen = [*topics, PARAMETER_EVENTS, ROSOUT, ACTIVE_MODE]
        files = {PARAMETERS_FILE: parameters} if parameters else {}
        recorded = [self._bag_topic(each) for each in chosen]
        self._bag = BagWriter(path, recorded, files, waits=stamped)
        self._inputs = [
            self.create_subscription(
                topic.message, topic.name, _never_called, _qos(topic), raw=True
            )
            for topic in chosen
        ]
        self._expected = [0 for _ in chosen]  # sequence numbers

    def _bag_topic(self, topic: Topic) -> BagTopic:
        from furuta_recordings.bags.message_types import definition_of, type_hash

        definition = definition_of(topic.type)
        qos = _OFFERED.get(topic) or offered_qos(QOS.depth)
        full_name = self.resolve_topic_name(topic.name)
        return BagTopic(full_name, topic.type, definition, qos, type_hash(topic.type, definition))

    def collect(self) -> None:
        """Add all received messages to the bag."""
        if self.failure is None:
            with self._reported_failures():
                self._collect()

    def _collect(self) -> None:
        indexes = range(len(self._inputs))
        received = [message for index in indexes for message in self._take(index)]
        for time, index, data in sorted(received):
            self._add(time, index, data)
        self._bag.flush()

    def _take(self, index: int) -> Iterator[tuple[int, int, bytes]]:
        """Time of arrival [ns], topic and content of each message received on a topic."""
        subscription = self._inputs[index]
        handle, message_type = subscription.handle, subscription.msg_type
        with handle:
            while (taken := handle.take_message(message_type, True)) is not None:
                data, info = taken
                self._count_dropped(index, info["publication_sequence_number"])
                yield info["received_timestamp"], index, data

    def _add(self, time: int, index: int, data: bytes) -> None:
        message_type = self._inputs[index].msg_type
        if message_type is ParameterEvent and not _changes_parameters(data):
            return
        if message_type is JointState and len(data) >= _STAMP_OFFSET + _STAMP.size:
            seconds, nanoseconds = _STAMP.unpack_from(data, _STAMP_OFFSET)
            self._newest_stamp = seconds * NANOSECONDS + nanoseconds
        self._bag.add(index, self._newest_stamp if self._stamped else time, data)
        self.kept += 1

    def _count_dropped(self, index: int, number: int) -> None:
        """Report messages that the middleware dropped before the one with this sequence number.

        With several publishers the numbers do not tell.
        """
        subscription, expected = self._inputs[index], self._expected[index]
        if 0 < expected < number and subscription.get_publisher_count() == 1:
            missing = number - expected
            self.lost += missing
            self.get_logger().warning(f"{missing} messages on {subscription.topic} were dropped")
        self._expected[index] = number + 1

    @contextmanager
    def _reported_failures(self) -> Iterator[None]:
        try:
            yield
        except UserError as error:
            if self.failure is None:
                self.failure = str(error)
                self.get_logger().error(
                    f"recording ended: {error}; `furuta bag recover` copies what was written before"
                )

    def close(self) -> None:
        """Collect what is left and finish the bag; may be called twice."""
        if not self._bag.closed:
            self.collect()
        with self._reported_failures():
            self._bag.close()

    def destroy_node(self) -> None:
        """Finish the bag with the node."""
        self.close()
        super().destroy_node()


# Creates the recorder of a run once ROS is started.
MakeRecorder = Callable[[], RecorderNode]


def chosen_topics(names: Iterable[str]) -> tuple[Topic, ...]:
    """The topics with these names; without names, all topics of the graph."""
    known = {topic.name: topic for topic in RECORDABLE}
    unknown = [name for name in names if name.strip("/") not in known]
    if unknown:
        raise ParameterError(f"no topic {unknown[0]} to record; there are {', '.join(known)}")
    return tuple(known[name.strip("/")] for name in names) or TOPICS


def _changes_parameters(data: bytes) -> bool:
    """Whether an event changes parameters; declaring them at a node's start does not count."""
    try:
        return bool(deserialized(data, ParameterEvent).changed_parameters)
    except RefusedError:
        return True  # the bag keeps what cannot be read


def _never_called(message: Any) -> None:
    """Callback of subscriptions that no executor serves."""


def _qos(topic: Topic) -> QoSProfile:
    """A long queue; on some topics also what was published before the recorder began."""
    qos = deep(RECEIVE_DEPTH)
    if topic in (ROSOUT, ACTIVE_MODE):
        qos.durability = QoSDurabilityPolicy.TRANSIENT_LOCAL
    return qos
