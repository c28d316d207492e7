"""For tests: nodes in one process, with a probe that publishes to them and collects their messages.

``with Bench() as bench``: :meth:`Bench.add` the nodes, :meth:`Bench.collect` topics, and
:meth:`Bench.run_until` a time.
"""

from array import array
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from time import monotonic
from typing import Any, Final, TypeVar

import rclpy
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState
from std_msgs.msg import Empty

from furuta_ros.node import QOS, deep
from furuta_ros.spinning import executor_of, ros_context, wait_until_matched
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import CLOCK, JOINTS, TOPICS, Topic

AnyNode = TypeVar("AnyNode", bound=Node)

# Parameters of a plant for :meth:`Bench.run_until`.
IN_LOCKSTEP: Final = (Parameter("clock", value="lockstep"),)
# Longest wait for a condition, and time in which a message would have come [s].
TIMEOUT, SETTLING = 120.0, 0.3
# Messages that wait for the probe while the nodes are faster.
QUEUE = 10_000


class Bench:
    """Nodes under test on one executor, in one process.

    By the probe's clock the time is simulated, so that no message is too old on a busy computer.

    Attributes:
        probe: A node that publishes and collects.
        received: The collected messages by the name of the topic.
    """

    def __init__(self, arguments: Sequence[str] = ()) -> None:
        """Start ROS with command-line ``arguments``, unless it runs.

        No node of another process is discovered then, whatever graph runs beside.
        """
        self._ros = ExitStack()
        if not rclpy.ok():
            self._ros.enter_context(ros_context(arguments, private=True))
        self.probe = Node("probe")
        self.clock = self.probe.create_publisher(CLOCK.message, CLOCK.name, QOS)
        self.received: dict[str, list[Any]] = {topic.name: [] for topic in TOPICS}
        self._collected: set[Topic] = set()
        self._marks: list[Empty] = []
        self._mark = self.probe.create_publisher(Empty, "~/mark", QOS)
        self.probe.create_subscription(Empty, "~/mark", self._marks.append, QOS)
        self._nodes: list[Node] = [self.probe]
        self._executor: Executor | None = None

    def __enter__(self) -> "Bench":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def add(self, node: AnyNode) -> AnyNode:
        """Put a node on the bench."""
        self._nodes.append(node)
        if self._executor is not None:
            self._executor.add_node(node)
        return node

    def node(self, name: str) -> Any:
        """The node of this name. Raises LookupError if there is none."""
        by_name = {node.get_name(): node for node in self._nodes}
        if name not in by_name:
            raise LookupError(f"no node {name} on the bench; it has {', '.join(by_name)}")
        return by_name[name]

    def collect(self, topic: Topic) -> list[Any]:
        """The messages on a topic, a list that grows; the same one at each call."""
        received = self.received.setdefault(topic.name, [])
        if topic not in self._collected:
            self._collected.add(topic)
            self.probe.create_subscription(topic.message, topic.name, received.append, deep(QUEUE))
        return received

    def publisher(self, topic: Topic) -> Publisher:
        """A publisher on a topic, known to a subscriber."""
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
        """The executor of all nodes."""
        if self._executor is None:
            self._executor = executor_of(self._nodes)
        return self._executor

    def spin(self, until: Callable[[], bool], timeout: float = TIMEOUT) -> None:
        """Spin until the condition holds.

        Raises:
            TimeoutError: It does not within ``timeout`` [s].
        """
        deadline = monotonic() + timeout
        while not until():
            if monotonic() > deadline:
                raise TimeoutError(f"the awaited condition did not come true in {timeout:g} s")
            self.executor.spin_once(timeout_sec=0.05)

    def run_until(self, seconds: float, timeout: float = TIMEOUT) -> None:
        """Run a graph with a plant in lock-step until its time is ``seconds``.

        The probe then has every message up to this time. A later call continues from there.

        Raises:
            ValueError: The plant refuses the time.
            TimeoutError: The plant does not get there; its log says which node is missing.
        """
        wait_until_matched(self._nodes)
        plant = self.node("plant")
        (result,) = plant.set_parameters([Parameter("run_until", value=float(seconds))])
        if not result.successful:
            raise ValueError(result.reason)
        self.spin(lambda: plant.paused, timeout)
        self._catch_up()

    def settle(self, seconds: float = SETTLING) -> None:
        """Spin long enough that a message that should not come would have come."""
        end = monotonic() + seconds
        while monotonic() < end:
            self.executor.spin_once(timeout_sec=0.05)

    def _catch_up(self) -> None:
        """Spin until the probe has what was published before: its own message comes after that."""
        before = len(self._marks)
        self._mark.publish(Empty())
        self.spin(lambda: len(self._marks) > before)

    def close(self) -> None:
        """End all nodes, then ROS if the bench has started it."""
        if self._executor is not None:
            self._executor.shutdown()
        for node in self._nodes:
            node.destroy_node()
        self._ros.close()


def joint_state(
    x: tuple[float, float, float, float],
    stamp: int,
    names: Sequence[str] = JOINTS,
    effort: float = 0.0,
) -> JointState:
    """A message with state x = (φ, φ̇, θ, θ̇) and the arm's effort, stamped in nanoseconds."""
    phi, phi_dot, theta, theta_dot = x
    message = JointState(name=list(names))
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, NANOSECONDS)
    message.position, message.velocity = array("d", [phi, theta]), array("d", [phi_dot, theta_dot])
    message.effort = array("d", [effort, 0.0])
    return message
