"""Publishes simulated time for nodes with ``use_sim_time``, and rejects it where it is wrong."""

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock

from furuta_ros.errors import UserError
from furuta_ros.node import QOS
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import CLOCK

# Simulated time between two messages [ns].
CLOCK_PERIOD = 10_000_000


class SimulatedClock:
    """Publishes simulated time on ``clock``, which is /clock for a graph without namespace.

    Once in each ``CLOCK_PERIOD`` is enough for displays and timers, and costs a sample little.
    """

    def __init__(self, node: Node, topic: str = CLOCK.name) -> None:
        self._publisher = node.create_publisher(CLOCK.message, topic, QOS)
        self._message = Clock()
        self.due = 0  # when the next message is due [ns]

    def advance(self, time: int) -> None:
        """Publish ``time`` [ns] if it is in a later ``CLOCK_PERIOD`` than the last message."""
        if time < self.due:
            return
        self.due = (time // CLOCK_PERIOD + 1) * CLOCK_PERIOD
        self._message.clock.sec, self._message.clock.nanosec = divmod(time, NANOSECONDS)
        self.repeat()

    def repeat(self) -> None:
        """Publish the last time again, for nodes that have joined while time stands still."""
        if self._publisher.get_subscription_count() > 0:
            self._publisher.publish(self._message)


def reject_simulated_time(node: Node, reason: str) -> None:
    """Reject ``use_sim_time`` for a node whose samples follow real time, now and later.

    Raises:
        UserError: The node was started with it.
    """
    error = f"use_sim_time must be false for {node.get_name()}, given true: {reason}"
    if node.get_parameter("use_sim_time").value:
        raise UserError(error)

    def check(parameters: list[Parameter]) -> SetParametersResult:
        wanted = any(p.name == "use_sim_time" and p.value for p in parameters)
        return SetParametersResult(successful=not wanted, reason=error if wanted else "")

    node.add_on_set_parameters_callback(check)
