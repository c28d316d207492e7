"""A controller node of your own, in plain rclpy: u = −L·x for every state estimate.

    ./furuta run --lockstep --without controller --seconds 2 &
    tools/in_environment python examples/own_controller_node.py    # Ctrl-C ends it

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


class StateFeedbackNode(Node):
    """Subscribes to ``joint_states``, publishes ``command`` [V], one for each state."""

    def __init__(self) -> None:
        super().__init__("controller")
        self.answered = 0
        self.publisher = self.create_publisher(Float64, "command", 10)
        self.create_subscription(JointState, "joint_states", self.on_state, 10)

    def on_state(self, message: JointState) -> None:
        """Answer a state with its command."""
        arm, pendulum = message.name.index("arm"), message.name.index("pendulum")
        positions, speeds = message.position, message.velocity
        x = positions[arm], speeds[arm], positions[pendulum], speeds[pendulum]
        command = -sum(gain * value for gain, value in zip(GAIN, x, strict=True))
        if abs(x[2]) > 0.7:  # it has fallen
            command = 0.0
        self.answered += 1
        self.publisher.publish(Float64(data=min(max(command, -10.0), 10.0)))


# rclpy's own handler of Ctrl-C would end ROS in the middle of a callback, and now and then it does
# not wake a spin() that waits. Python's handler acts when a spin with a timeout returns.
rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
signal(SIGINT, default_int_handler)  # a background job would start without it
node, executor = StateFeedbackNode(), SingleThreadedExecutor()
executor.add_node(node)
try:
    while True:
        executor.spin_once(timeout_sec=0.1)
except KeyboardInterrupt:
    print(f"{node.answered} states answered")
    rclpy.shutdown()

# prints
# 2000 states answered
