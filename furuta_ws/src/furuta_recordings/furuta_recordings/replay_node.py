"""Node ``replay``: recorded messages on their topics again."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from time import monotonic, sleep
from typing import Any, NamedTuple

from rclpy.node import Node
from rclpy.publisher import Publisher
from rosgraph_msgs.msg import Clock

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import Bag
from furuta_ros.errors import UserError
from furuta_ros.messages import NANOSECONDS
from furuta_ros.topics import deep

# Depth of the publishers' queues: what a reader may lag behind at full speed, and what is still
# there when the middleware asks again, seconds later, for a message that its transport lost.
DEPTH = 20_000
# Longest wait for readers [s], and seconds of the bag between two times of /clock.
PATIENCE = 30.0
TICK = 0.01
# Longest sleep [s] before it is looked whether to stop.
NAP = 0.1


class ReplayOptions(NamedTuple):
    """How to replay: ``rate`` (0: as fast as possible), ``topics`` (none: all), remapping."""

    rate: float = 1.0
    topics: tuple[str, ...] = ()
    remap: tuple[tuple[str, str], ...] = ()
    clock: bool = False
    wait: bool = False


class ReplayNode(Node):
    """Publishes what a bag holds, in its order."""

    def __init__(self, bag: Path, options: ReplayOptions) -> None:
        super().__init__("replay")
        self._bag, self._options = bag, options
        self.published = 0
        self.latest = 0.0
        self._channels: dict[str, Publisher] = {}
        with Bag(bag) as reader:
            kinds = {c.topic: c.msgtype for c in reader.connections}
        wanted = {_full(topic) for topic in options.topics}
        unknown = wanted - {_full(topic) for topic in kinds}
        if unknown:
            raise ParameterError(
                f"{bag} has no topic {', '.join(sorted(unknown))}; it has {', '.join(kinds)}"
            )
        names = {_full(a): b for a, b in options.remap}
        for topic, kind in kinds.items():
            if wanted and _full(topic) not in wanted:
                continue
            made = _message_class(kind)
            if made is None:
                if wanted:
                    raise ParameterError(f"{topic}: the type {kind} is not installed")
                self.get_logger().warning(f"left out {topic}: the type {kind} is not installed")
                continue
            self._channels[topic] = self.create_publisher(
                made, names.get(_full(topic), topic), deep(DEPTH)
            )
        self._ticker = self.create_publisher(Clock, "/clock", deep(10)) if options.clock else None

    def play(self, stop: Callable[[], bool]) -> None:
        """Publish everything, or until ``stop()``."""
        if self._options.wait:
            self._wait(stop)
        began, first, tick = 0.0, None, -1
        with Bag(self._bag) as reader:
            chosen = [c for c in reader.connections if c.topic in self._channels]
            for connection, time, data in reader.messages(chosen):
                if first is None:
                    began, first = monotonic(), time
                if self._options.rate > 0.0:
                    due = began + (time - first) / NANOSECONDS / self._options.rate
                    self._sleep_until(due, stop)
                    self.latest = max(self.latest, monotonic() - due)
                if stop():
                    return
                if self._ticker is not None and time // int(TICK * NANOSECONDS) > tick:
                    tick = time // int(TICK * NANOSECONDS)
                    self._tell(time)
                self._channels[connection.topic].publish(bytes(data))
                self.published += 1
        for publisher in self._channels.values():
            publisher.wait_for_all_acked()

    def _sleep_until(self, due: float, stop: Callable[[], bool]) -> None:
        while (left := due - monotonic()) > 0.0 and not stop():
            sleep(min(left, NAP))

    def _tell(self, time: int) -> None:
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(time, NANOSECONDS)
        assert self._ticker is not None
        self._ticker.publish(message)

    def _wait(self, stop: Callable[[], bool]) -> None:
        """Return once every topic has a reader."""
        deadline = monotonic() + PATIENCE
        while not stop():
            alone = [
                p.topic_name for p in self._channels.values() if not p.get_subscription_count()
            ]
            if not alone:
                return
            if monotonic() > deadline:
                raise UserError(f"nobody reads {', '.join(alone)} (waited {PATIENCE:g} s)")
            sleep(0.02)


def _full(topic: str) -> str:
    return "/" + topic.strip("/")


def _message_class(kind: str) -> Any:
    package, _, rest = kind.partition("/")
    try:
        return getattr(importlib.import_module(f"{package}.msg"), rest.rpartition("/")[2], None)
    except ImportError:
        return None
