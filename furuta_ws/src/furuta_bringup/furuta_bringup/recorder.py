"""Node ``recorder``: topics into a bag that survives whatever happens to this process."""

from __future__ import annotations

import struct
from collections import deque
from collections.abc import Iterable, Sequence
from pathlib import Path
from threading import Event, Thread
from time import monotonic
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rclpy.node import Node
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState

from furuta_ros.messages import NANOSECONDS
from furuta_ros.topics import QOS, TOPICS, Topic, deep

from .bag_writer import BagWriter
from .mcap_file import Kind

# Seconds between two turns of the writing thread, and between two times that it makes them last.
TURN = 0.02
LASTING = 0.25
# Messages that the thread may lag behind.
LONGEST_QUEUE = 100_000
# Messages that may wait for this node while others of its executor run.
RECEIVE_DEPTH = 10_000
PARAMETER_EVENTS = Topic("/parameter_events", ParameterEvent)
PARAMETERS_FILE = "parameters.yaml"


class Recorder(Node):
    """Writes topics as they are, undecoded, to ``path``.

    A thread of its own writes: one write can take longer than many samples. What was received
    is safe after ``LASTING`` seconds. With ``stamped`` a message is filed under the newest time
    stamp seen, which makes the bag of a lock-step run repeatable; otherwise under the time of
    its arrival. Where writing fails, on a full disk say, recording ends with a message and the
    graph runs on; the bag holds what came before.

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
        super().__init__("recorder")
        self._stamped = stamped
        self._stamp = 0
        self.failure: str | None = None
        self._queue: deque[tuple[int, int, bytes]] = deque()
        chosen = [*topics, PARAMETER_EVENTS]
        kept = {PARAMETERS_FILE: parameters} if parameters else {}
        self._writer = BagWriter(path, self._kinds(chosen), kept)
        for index, topic in enumerate(chosen[:-1]):
            self._subscribe(index, topic)
        self._subscribe_to_parameters(len(chosen) - 1)
        self._stop = Event()
        self._thread = Thread(target=self._write, name="recorder")
        self._thread.start()

    def _kinds(self, topics: Sequence[Topic]) -> list[Kind]:
        types = get_typestore(Stores.ROS2_JAZZY)
        return [
            Kind(
                self.resolve_topic_name(topic.name),
                name,
                types.generate_msgdef(name, ros_version=2)[0],
                _QOS,
            )
            for topic in topics
            for name in [_type_name(topic)]
        ]

    def _subscribe(self, index: int, topic: Topic) -> None:
        stamped = self._stamped and topic.type is JointState

        def receive(data: bytes) -> None:
            if self.failure is not None:
                return
            if stamped:
                seconds, nanoseconds = struct.unpack_from("<iI", data, 4)
                self._stamp = seconds * NANOSECONDS + nanoseconds
            time = self._stamp if self._stamped else self.get_clock().now().nanoseconds
            self._queue.append((index, time, data))
            if self._stamped and len(self._queue) > LONGEST_QUEUE:
                self._stop.wait(TURN)

        self.create_subscription(topic.type, topic.name, receive, deep(RECEIVE_DEPTH), raw=True)

    def _subscribe_to_parameters(self, index: int) -> None:
        """Keep changes of parameters; their declaration at a node's start is none."""

        def receive(event: ParameterEvent) -> None:
            if event.changed_parameters and self.failure is None:
                now = self.get_clock().now().nanoseconds
                time = self._stamp if self._stamped else now
                self._queue.append((index, time, serialize_message(event)))

        self.create_subscription(
            ParameterEvent, PARAMETER_EVENTS.name, receive, deep(RECEIVE_DEPTH)
        )

    def _write(self) -> None:
        queue, writer = self._queue, self._writer
        lasting = monotonic()
        try:
            while not (self._stop.wait(TURN) and not queue):
                for _ in range(len(queue)):
                    writer.add(*queue.popleft())
                if monotonic() - lasting >= LASTING:
                    writer.flush()
                    lasting = monotonic()
            writer.close()
        except OSError as error:
            self.failure = f"{writer.path}: {error.strerror}"
            queue.clear()
            self.get_logger().error(f"recording ended: {self.failure}; what came before is kept")

    def close(self) -> None:
        """Write what is left and finish the bag."""
        self._stop.set()
        self._thread.join()

    def destroy_node(self) -> None:
        """Finish the bag with the node."""
        if self._thread.is_alive():
            self.close()
        super().destroy_node()


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
