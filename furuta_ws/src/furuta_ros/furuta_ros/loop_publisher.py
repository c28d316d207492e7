"""Publishes a topic of the loop, and some of its messages again on its throttled copy.

A program that draws needs a hundred samples per second. Receiving all of them would cost the
publisher's process time on every sample.
"""

from collections.abc import Callable

from rclpy.node import Node
from rclpy.publisher import Publisher

from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import QOS, Topic

# Shortest time between two messages on the copy, by the stamps of their samples [ns].
PERIOD = NANOSECONDS // 100


def sender(publisher: Publisher) -> Callable[[bytes], None]:
    """Publishes serialised messages.

    ``publisher.publish`` first asks of each message which type it has, for a third of its time.
    """
    send: Callable[[bytes], None] = publisher.handle.publish_raw
    return send


class LoopPublisher:
    """Publishes serialised messages on ``topic`` and on its throttled copy."""

    def __init__(self, node: Node, topic: Topic) -> None:
        copy = topic.throttled
        self._publisher = node.create_publisher(topic.type, topic.name, QOS)
        self._send = sender(self._publisher)
        self._copy = node.create_publisher(copy.type, copy.name, QOS)
        self._last = -PERIOD

    def publish(self, data: bytes, stamp: int) -> None:
        """Publish the message of the sample at ``stamp`` [ns]."""
        self._send(data)
        if not self._last <= stamp < self._last + PERIOD:
            self._last = stamp
            if self._copy.get_subscription_count() > 0:
                self._copy.publish(data)

    def is_wanted(self) -> bool:
        """Whether somebody subscribes to either."""
        publishers = self._publisher, self._copy
        return any(each.get_subscription_count() > 0 for each in publishers)
