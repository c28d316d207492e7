"""A controller node of one's own, in plain rclpy: u = -L·x from every state estimate.

    ./furuta run --without controller &
    tools/in_environment python examples/state_feedback_node.py

It uses the topics of the graph and nothing else of this workspace.
"""

from signal import SIGINT, default_int_handler, signal

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

# L for (φ, φ̇, θ, θ̇) by linear-quadratic design [V/rad, V s/rad, V/rad, V s/rad].
GAIN = [-2.0, -1.25, -15.74, -3.03]
LIMIT = 10.0  # largest command [V]
FALL_ANGLE = 0.7  # pendulum angle beyond which the command is 0 V [rad]


class StateFeedbackNode(Node):
    """Subscribes to ``joint_states``, publishes ``command`` [V], one for each state."""

    def __init__(self) -> None:
        super().__init__("controller")
        self.declare_parameter("gain", GAIN)
        self.publisher = self.create_publisher(Float64, "command", 10)
        self.create_subscription(JointState, "joint_states", self.on_state, 10)

    def on_state(self, message: JointState) -> None:
        """Answer a state with its command."""
        arm, pendulum = message.name.index("arm"), message.name.index("pendulum")
        theta = message.position[pendulum]
        state = (message.position[arm], message.velocity[arm], theta, message.velocity[pendulum])
        gains = self.get_parameter("gain").value  # ros2 param set applies at the next state
        command = -sum(gain * value for gain, value in zip(gains, state, strict=True))
        if abs(theta) > FALL_ANGLE:
            command = 0.0
        self.publisher.publish(Float64(data=min(max(command, -LIMIT), LIMIT)))


def main() -> None:
    """Run the node until Ctrl-C."""
    # rclpy's own handler of Ctrl-C would end ROS in the middle of a callback, and now and then it
    # does not wake a spin() that waits. Python's handler acts when a spin with a timeout returns.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    signal(SIGINT, default_int_handler)  # a background job would start without it
    executor = SingleThreadedExecutor()
    executor.add_node(StateFeedbackNode())
    try:
        while True:
            executor.spin_once(timeout_sec=0.1)
    except KeyboardInterrupt:
        rclpy.shutdown()


if __name__ == "__main__":
    main()
