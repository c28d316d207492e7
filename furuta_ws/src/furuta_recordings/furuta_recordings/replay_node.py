"""Node ``replay``: publishes the messages of a bag on their topics."""

from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from time import monotonic, sleep
from typing import Any, NamedTuple

from rclpy.node import Node
from rclpy.publisher import Publisher

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import Bag, last_part
from furuta_ros.errors import UserError, first_line
from furuta_ros.node import deep
from furuta_ros.simulated_clock import SimulatedClock
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import ACTIVE_MODE, PARAMETER_EVENTS, ROSOUT

# Depth of the publishers' queues. At full speed a subscriber may be this far behind, and the
# middleware may ask, seconds later, for a message that its transport has lost.
QUEUE_DEPTH = 20_000
# Longest wait for subscribers [s].
SUBSCRIBER_TIMEOUT = 30.0
# Where nodes with use_sim_time expect the time.
CLOCK_TOPIC = "/clock"
# Longest sleep [s] between two checks whether to stop.
LONGEST_SLEEP = 0.1
# Parts of the bag's time, after each of which its replay says how far it is.
PARTS = 100


class ReplayOptions(NamedTuple):
    """How to replay: ``rate`` (0: as fast as possible), ``topics`` (none: all), remapping."""

    rate: float = 1.0
    topics: tuple[str, ...] = ()
    remap: tuple[tuple[str, str], ...] = ()
    clock: bool = False
    wait: bool = False


class ReplayNode(Node):
    """Publishes the messages of a bag in their order.

    ``published`` counts them; ``latest`` is the largest delay of one [s].
    """

    def __init__(self, bag: Path, options: ReplayOptions) -> None:
        super().__init__("replay")
        self._bag, self._options = bag, options
        self.published = 0
        self.latest = 0.0
        # Monotonic time [s] and time of the bag [ns] at the first message.
        self._start: tuple[float, int] | None = None
        self._topic_publishers: dict[str, Publisher] = {}
        names = {_absolute(old): new for old, new in options.remap}
        for topic, type_name in self._chosen_types().items():
            kind = message_class(type_name)
            if kind is not None:
                self._topic_publishers[topic] = self.create_publisher(
                    kind, names.get(_absolute(topic), topic), deep(QUEUE_DEPTH)
                )
            elif options.topics:
                raise ParameterError(f"{topic}: the type {type_name} is not installed")
            else:
                self.get_logger().warning(f"left out {topic!r}: {type_name!r} is not installed")
        self._bag_clock = SimulatedClock(self, CLOCK_TOPIC) if options.clock else None

    def _chosen_types(self) -> dict[str, str]:
        """Topics to replay with their types; the replay's own clock replaces a recorded one."""
        with Bag(self._bag) as bag:
            types = {c.topic: c.msgtype for c in bag.connections}
        if self._options.clock:
            types = {topic: t for topic, t in types.items() if _absolute(topic) != CLOCK_TOPIC}
        wanted = {_absolute(topic) for topic in self._options.topics}
        unknown = wanted - {_absolute(topic) for topic in types}
        if unknown:
            raise ParameterError(
                f"{self._bag} has no topic {', '.join(sorted(unknown))}; it has {', '.join(types)}"
            )
        return {topic: t for topic, t in types.items() if not wanted or _absolute(topic) in wanted}

    def play(self, stop: Callable[[], bool]) -> Iterator[int]:
        """Publish everything, or until ``stop()``; yields after each of the bag's :data:`PARTS`."""
        if self._options.wait:
            self._wait_for_subscribers(stop)
        with Bag(self._bag) as bag:
            chosen = [c for c in bag.connections if c.topic in self._topic_publishers]
            part, played = max(1, int(bag.seconds * NANOSECONDS) // PARTS), 0
            for connection, time, data in bag.messages(chosen):
                self._sleep_until_due(time, stop)
                if stop():
                    return
                if self._bag_clock is not None:
                    self._bag_clock.advance(time)
                try:
                    self._topic_publishers[connection.topic].publish(bytes(data))
                except RuntimeError as error:  # of ROS: not a message of the topic's type
                    reason = f"{connection.topic}: {first_line(error)}"
                    raise UserError(f"cannot replay {reason}") from None
                self.published += 1
                while played < min(PARTS, (time - bag.start) // part):
                    yield (played := played + 1)
        for publisher in self._topic_publishers.values():
            publisher.wait_for_all_acked()

    def _sleep_until_due(self, time: int, stop: Callable[[], bool]) -> None:
        """Sleep until the bag's ``time`` [ns] is due at the chosen rate."""
        if self._start is None:
            self._start = monotonic(), time
        if self._options.rate == 0.0:
            return
        started, first = self._start
        due = started + (time - first) / NANOSECONDS / self._options.rate
        while (left := due - monotonic()) > 0.0 and not stop():
            sleep(min(left, LONGEST_SLEEP))
        self.latest = max(self.latest, monotonic() - due)

    def _wait_for_subscribers(self, stop: Callable[[], bool]) -> None:
        """Return when every topic has a subscriber, except those that only report."""
        deadline = monotonic() + SUBSCRIBER_TIMEOUT
        publishers = [
            publisher
            for topic, publisher in self._topic_publishers.items()
            if topic not in (PARAMETER_EVENTS.name, ROSOUT.name)
            and last_part(topic) != ACTIVE_MODE.name
        ]
        while not stop():
            missing = [p.topic_name for p in publishers if not p.get_subscription_count()]
            if not missing:
                return
            if monotonic() > deadline:
                raise UserError(
                    f"no subscriber on {', '.join(missing)} (waited {SUBSCRIBER_TIMEOUT:g} s)"
                )
            sleep(0.02)


def _absolute(topic: str) -> str:
    return "/" + topic.strip("/")


def message_class(type_name: str) -> Any:
    """The class of a message type; None if it is not installed."""
    package, _, rest = type_name.partition("/")
    if not _has_messages(package):
        return None
    return getattr(import_module(f"{package}.msg"), rest.rpartition("/")[2], None)


def _has_messages(package: str) -> bool:
    """Whether a package holds ROS messages. A bag can name any package: it must not be imported."""
    spec = find_spec(package) if package.isidentifier() else None
    folders = (spec and spec.submodule_search_locations) or ()
    name = f"{package}_s__rosidl_typesupport_c.*"
    return any(any(Path(folder).glob(name)) for folder in folders)
