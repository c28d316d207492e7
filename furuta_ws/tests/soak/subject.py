"""A node whose callbacks are called directly, without the middleware."""

from collections.abc import Callable
from typing import Any
from unittest.mock import patch

from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Float64

from soak.mutators import Change

# What the middleware says about a message.
NO_INFO = {"source_timestamp": 0}


class Subject:
    """A node whose callbacks are called directly, and what it has published."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self.published: list[tuple[float, ...]] = []
        with patch("furuta_ros.loop_publisher.sender", self._sender):
            self.node = make()
        self._callbacks = {each.topic_name: each.callback for each in self.node.subscriptions}

    def _sender(self, publisher: Any) -> Callable[[bytes], None]:
        return lambda data: self._keep(deserialize_message(data, publisher.msg_type))

    def _keep(self, message: Any) -> None:
        if isinstance(message, Float64):
            self.published.append((message.data,))
        else:
            arrays = (message.position, message.velocity, message.effort)
            self.published.append(tuple(float(v) for array in arrays for v in array))

    def give(self, topic: str, message: Any) -> tuple[bool, list[tuple[float, ...]]]:
        """Give a message; returns whether it was refused, and what was published."""
        self.published = []
        refused = self.node.refused
        self._callbacks[f"/{topic}"](serialize_message(message), NO_INFO)
        return self.node.refused > refused, self.published

    def change(self, change: Change) -> tuple[bool, str]:
        """Change parameters as the service does; returns whether it was refused, and why."""
        try:
            result = self.node.set_parameters_atomically(change.parameters)
        except ParameterNotDeclaredException as error:  # the service refuses then
            return True, str(error)
        return not result.successful, result.reason
