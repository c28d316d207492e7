"""Shared by all tests: a ROS domain of this process's own, and a probe beside the nodes."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from time import monotonic
from typing import Any

import pytest

DOMAINS = range(1, 100)
TIMEOUT = 30.0


def _own_domain() -> Any:
    """Take the first ROS domain that no other test process holds; keep the lock while alive."""
    for domain in DOMAINS:
        lock = (Path(tempfile.gettempdir()) / f"furuta-test-domain-{domain}").open("w")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.close()
            continue
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        return lock
    raise RuntimeError("every ROS domain for tests is taken")


os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
_DOMAIN_LOCK = _own_domain()

import rclpy  # noqa: E402 - the domain is read when rclpy starts
from furuta_bringup.settings import NODES, Settings  # noqa: E402
from furuta_ros.messages import JointWriter  # noqa: E402
from furuta_ros.spinning import executor_of  # noqa: E402
from furuta_ros.topics import QOS, TOPICS, Topic  # noqa: E402
from rclpy.executors import Executor  # noqa: E402
from rclpy.node import Node  # noqa: E402
from rclpy.signals import SignalHandlerOptions  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402


@pytest.fixture
def ros() -> Iterator[None]:
    """ROS from start to end of a test."""
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    yield
    rclpy.try_shutdown()


@pytest.fixture
def bench(ros: None) -> Iterator[Bench]:
    """A test bench for nodes."""
    bench = Bench()
    yield bench
    bench.close()


class Bench:
    """Nodes under test with a probe that publishes and collects."""

    def __init__(self) -> None:
        self.probe = Node("probe")
        self.received: dict[str, list[Any]] = {topic.name: [] for topic in TOPICS}
        self._nodes: list[Node] = [self.probe]
        self._executor: Executor | None = None

    def add(self, node: Any) -> Any:
        """Put a node on the bench."""
        self._nodes.append(node)
        return node

    def collect(self, topic: Topic) -> list[Any]:
        """Collect what comes on a topic."""
        received = self.received[topic.name]
        self.probe.create_subscription(topic.type, topic.name, received.append, QOS)
        return received

    def publisher(self, topic: Topic) -> Any:
        """A publisher on a topic, known to its subscribers."""
        publisher = self.probe.create_publisher(topic.type, topic.name, QOS)
        self.spin(lambda: publisher.get_subscription_count() > 0)
        return publisher

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


@pytest.fixture
def settings() -> Settings:
    """Settings that leave every parameter at its default."""
    return {node: {} for node in NODES}


def joint_state(
    x: tuple[float, float, float, float], stamp: int, names: list[str] | None = None
) -> JointState:
    """A message with state x = (φ, φ̇, θ, θ̇), stamped in nanoseconds."""
    writer = JointWriter()
    writer.stamp(stamp)
    message = writer.fill(x)
    if names is not None:
        message.name = names
    return message
