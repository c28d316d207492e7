"""Node ``recorder``: the graph's topics into a rosbag2 bag."""

from __future__ import annotations

import struct
from collections import deque
from pathlib import Path
from threading import Event, Thread

from rclpy.node import Node
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState

from furuta_model.parameters import ParameterError
from furuta_ros.messages import NANOSECONDS
from furuta_ros.topics import QOS, TOPICS, Topic, deep

# Seconds between two turns of the writing thread, and messages it may lag behind.
TURN = 0.02
LONGEST_QUEUE = 100_000
# Messages that may wait for this node while others of its executor run.
RECEIVE_DEPTH = 10_000


class Recorder(Node):
    """Writes all topics of the graph as they are, undecoded, to ``path``.

    Messages are written by a thread of their own: one write can take longer than many samples.
    With ``stamped`` a message is filed under the newest time stamp seen, which makes the bag of
    a lock-step run repeatable; otherwise under the time of its arrival.
    """

    def __init__(self, path: Path, stamped: bool = False) -> None:
        super().__init__("recorder")
        if path.exists():
            raise ParameterError(f"{path} exists already; name another directory for the bag")
        path.parent.mkdir(parents=True, exist_ok=True)
        self._stamped = stamped
        self._stamp = 0
        self._queue: deque[tuple[int, int, bytes]] = deque()
        self._writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
        self._writer.open()
        types = get_typestore(Stores.ROS2_JAZZY)
        self._connections = [
            self._writer.add_connection(
                self.resolve_topic_name(topic.name),
                _type_name(topic),
                typestore=types,
                offered_qos_profiles=[_OFFERED],
            )
            for topic in TOPICS
        ]
        for index, topic in enumerate(TOPICS):
            self._subscribe(index, topic)
        self._stop = Event()
        self._thread = Thread(target=self._write, name="recorder")
        self._thread.start()

    def _subscribe(self, index: int, topic: Topic) -> None:
        stamped = self._stamped and topic.type is JointState

        def receive(data: bytes) -> None:
            if stamped:
                seconds, nanoseconds = struct.unpack_from("<iI", data, 4)
                self._stamp = seconds * NANOSECONDS + nanoseconds
            time = self._stamp if self._stamped else self.get_clock().now().nanoseconds
            self._queue.append((index, time, data))
            if self._stamped and len(self._queue) > LONGEST_QUEUE:
                self._stop.wait(TURN)

        self.create_subscription(topic.type, topic.name, receive, deep(RECEIVE_DEPTH), raw=True)

    def _write(self) -> None:
        queue, writer, connections = self._queue, self._writer, self._connections
        while not (self._stop.wait(TURN) and not queue):
            for _ in range(len(queue)):
                index, time, data = queue.popleft()
                writer.write(connections[index], time, data)

    def close(self) -> None:
        """Write what is left and finish the bag."""
        self._stop.set()
        self._thread.join()
        self._writer.close()

    def destroy_node(self) -> None:
        """Finish the bag with the node."""
        if self._thread.is_alive():
            self.close()
        super().destroy_node()


def _type_name(topic: Topic) -> str:
    package, _, _ = topic.type.__module__.partition(".")
    return f"{package}/msg/{topic.type.__name__}"


_UNLIMITED = QosTime(2147483647, 4294967295)
_OFFERED = Qos(
    QosHistory.KEEP_LAST,
    QOS.depth,
    QosReliability.RELIABLE,
    QosDurability.VOLATILE,
    _UNLIMITED,
    _UNLIMITED,
    QosLiveliness.AUTOMATIC,
    _UNLIMITED,
    False,
)
