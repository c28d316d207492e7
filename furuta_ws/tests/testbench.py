"""A test bench for nodes: a probe node publishes to them and collects their messages."""

from array import array
from collections import Counter
from collections.abc import Callable
from functools import wraps
from time import monotonic
from typing import Any

from rclpy.executors import Executor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from furuta_ros.node import QOS, LoopPublisher, deep
from furuta_ros.spinning import executor_of
from furuta_ros.topics import CLOCK, JOINTS, TOPICS, Topic

TIMEOUT = 120.0


class Bench:
    """Nodes under test with a probe that publishes and collects.

    By its clock the time is simulated, so that no message is too old on a busy computer.
    """

    def __init__(self) -> None:
        self.probe = Node("probe")
        self.clock = self.probe.create_publisher(CLOCK.message, CLOCK.name, QOS)
        self.received: dict[str, list[Any]] = {topic.name: [] for topic in TOPICS}
        self._nodes: list[Node] = [self.probe]
        self._executor: Executor | None = None

    def add(self, node: Any) -> Any:
        """Put a node on the bench."""
        self._nodes.append(node)
        return node

    def node(self, name: str) -> Any:
        """The node of this name."""
        return next(node for node in self._nodes if node.get_name() == name)

    def collect(self, topic: Topic) -> list[Any]:
        """Collect what comes on a topic."""
        received = self.received.setdefault(topic.name, [])
        self.probe.create_subscription(topic.message, topic.name, received.append, deep(10_000))
        return received

    def publisher(self, topic: Topic) -> Any:
        """A publisher on a topic, known to its subscribers."""
        publisher = self.probe.create_publisher(topic.message, topic.name, QOS)
        self.spin(lambda: publisher.get_subscription_count() > 0)
        return publisher

    def wait_for_publisher(self, topic: Topic) -> None:
        """Spin until the probe's subscription to a topic is matched with a publisher."""
        name = self.probe.resolve_topic_name(topic.name)
        mine = [each for each in self.probe.subscriptions if each.topic_name == name]
        self.spin(lambda: all(each.get_publisher_count() > 0 for each in mine))

    @property
    def executor(self) -> Executor:
        """The executor of all nodes; none is added after its first use."""
        if self._executor is None:
            self._executor = executor_of(self._nodes)
        return self._executor

    def spin(self, until: Callable[[], bool], timeout: float = TIMEOUT) -> None:
        """Spin until the condition holds; fail if it does not."""
        deadline = monotonic() + timeout
        while not until():
            assert monotonic() < deadline, "the awaited condition did not come true"
            self.executor.spin_once(timeout_sec=0.05)

    def count_handled(self, node: Any) -> Counter[str]:
        """Counts the messages that the callbacks of a node have handled, by topic name."""
        handled: Counter[str] = Counter()

        def counted(name: str, callback: Callable[..., None]) -> Callable[..., None]:
            @wraps(callback)
            def call(*arguments: Any) -> None:
                callback(*arguments)
                handled[name] += 1

            return call

        for each in node.subscriptions:
            each.callback = counted(each.topic_name.strip("/"), each.callback)
        return handled

    def count_published(self, publisher: LoopPublisher) -> Counter[str]:
        """Counts what is published in the loop, as ``messages``."""
        published: Counter[str] = Counter()
        publish = publisher.publish

        def counted(data: bytes, stamp: int) -> None:
            published["messages"] += 1
            publish(data, stamp)

        publisher.publish = counted  # type: ignore[method-assign]
        return published

    def settle(self, seconds: float = 0.3) -> None:
        """Spin long enough that a message that should not come would have come."""
        end = monotonic() + seconds
        while monotonic() < end:
            self.executor.spin_once(timeout_sec=0.05)

    def close(self) -> None:
        """End all nodes."""
        if self._executor is not None:
            self._executor.shutdown()
        for node in self._nodes:
            node.destroy_node()


def joint_state(
    x: tuple[float, float, float, float],
    stamp: int,
    names: list[str] | None = None,
    effort: float = 0.0,
) -> JointState:
    """A message with state x = (φ, φ̇, θ, θ̇) and the arm's effort, stamped in nanoseconds."""
    phi, phi_dot, theta, theta_dot = x
    message = JointState(name=names or list(JOINTS))
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 1_000_000_000)
    message.position, message.velocity = array("d", [phi, theta]), array("d", [phi_dot, theta_dot])
    message.effort = array("d", [effort, 0.0])
    return message
