"""References for the graph's speed: four nodes that pass the same messages and compute nothing.

Topics, types, quality of service, subscriptions and executor are the same as in the graph. The
messages are typed, as a ROS developer writes it, or serialised, as in the graph.
"""

from array import array
from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from furuta_ros.node import QOS
from furuta_ros.spinning import executor_of, prepare_to_spin
from furuta_ros.topics import (
    COMMAND,
    FRICTION_ESTIMATE,
    GROUND_TRUTH,
    JOINT_STATES,
    JOINTS,
    MEASUREMENT,
    Topic,
)


class BareChain:
    """Plant, estimator, friction observer and controller without their computations."""

    def __init__(self, serialised: bool = False) -> None:
        self.count = 0
        self.on_command: Callable[[], None] = self.publish_sample
        self._serialised = serialised
        self._measurement = self._message(_joint_state())
        self._truth = self._message(_joint_state())
        self._state = self._message(_joint_state())
        self._friction, self._command = self._message(Float64()), self._message(Float64())
        names = ("bare_plant", "bare_estimator", "bare_observer", "bare_controller")
        namespace = "serialised" if serialised else "bare"
        self.nodes = [Node(name, namespace=namespace) for name in names]
        plant, estimator, observer, controller = self.nodes
        self._measurement_publisher = _publisher(plant, MEASUREMENT)
        self._truth_publisher = _publisher(plant, GROUND_TRUTH)
        self._state_publisher = _publisher(estimator, JOINT_STATES)
        self._friction_publisher = _publisher(observer, FRICTION_ESTIMATE)
        self._command_publisher = _publisher(controller, COMMAND)
        subscribe = self._subscribe
        subscribe(estimator, MEASUREMENT, lambda _: self._state_publisher.publish(self._state))
        subscribe(
            observer, JOINT_STATES, lambda _: self._friction_publisher.publish(self._friction)
        )
        subscribe(controller, JOINT_STATES, lambda _: None)
        subscribe(
            controller, FRICTION_ESTIMATE, lambda _: self._command_publisher.publish(self._command)
        )
        subscribe(plant, COMMAND, self._on_command)
        self.executor = executor_of(self.nodes)
        prepare_to_spin()

    @property
    def matched(self) -> bool:
        """Whether every publisher has discovered its subscriptions."""
        return (
            self._state_publisher.get_subscription_count() == 2
            and self._measurement_publisher.get_subscription_count() == 1
            and self._friction_publisher.get_subscription_count() == 1
            and self._command_publisher.get_subscription_count() == 1
        )

    def publish_sample(self) -> None:
        """Publish one sample, which travels through all nodes."""
        self._truth_publisher.publish(self._truth)
        self._measurement_publisher.publish(self._measurement)

    def close(self) -> None:
        """Destroy the nodes."""
        self.executor.shutdown()
        for node in self.nodes:
            node.destroy_node()

    def _message(self, message: Any) -> Any:
        return bytes(serialize_message(message)) if self._serialised else message

    def _subscribe(self, node: Node, topic: Topic, receive: Callable[[Any], None]) -> None:
        node.create_subscription(topic.message, topic.name, receive, QOS, raw=self._serialised)

    def _on_command(self, _: Any) -> None:
        self.count += 1
        self.on_command()


def _publisher(node: Node, topic: Topic) -> Publisher:
    return node.create_publisher(topic.message, topic.name, QOS)


def _joint_state() -> JointState:
    zeros = array("d", (0.0, 0.0))
    return JointState(name=list(JOINTS), position=zeros, velocity=zeros, effort=zeros)
