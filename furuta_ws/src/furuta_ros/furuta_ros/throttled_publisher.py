"""Publishes some messages of a topic again, on its throttled copy.

A program that draws needs a hundred samples per second. Receiving all of them would cost the
publisher's process time on every sample.
"""

from __future__ import annotations

from typing import Any

from rclpy.node import Node

from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import QOS, Topic

# Shortest time between two messages, by the stamps of their samples [ns].
PERIOD = NANOSECONDS // 100


class ThrottledPublisher:
    """The publisher of the throttled copy of ``topic``; publishes while there is a subscriber."""

    def __init__(self, node: Node, topic: Topic) -> None:
        copy = topic.throttled
        self._publisher = node.create_publisher(copy.type, copy.name, QOS)
        self._last = -PERIOD

    def publish(self, message: Any, stamp: int) -> None:
        """Publish the message of the sample at ``stamp`` [ns] if the last one is old enough."""
        if 0 <= stamp - self._last < PERIOD:
            return
        self._last = stamp
        if self._publisher.get_subscription_count():
            self._publisher.publish(message)
