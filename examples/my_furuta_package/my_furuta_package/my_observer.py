"""Node ``friction_observer`` of my own: F̂ = α₀ tanh(φ̇/w) for every state estimate."""

from contextlib import suppress
from math import tanh

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64


class MyObserver(Node):
    """Subscribes to ``joint_states``, publishes ``friction_estimate`` [V], one for each state."""

    def __init__(self) -> None:
        super().__init__("friction_observer")
        self.declare_parameter("alpha0", 0.21)  # friction while the arm slides [V]
        self.declare_parameter("width", 0.03)  # speed at which tanh is 0.76 [rad/s]
        self.publisher = self.create_publisher(Float64, "friction_estimate", 10)
        self.create_subscription(JointState, "joint_states", self.on_state, 10)

    def on_state(self, message: JointState) -> None:
        """Answer a state with its friction estimate."""
        alpha0, width = (self.get_parameter(name).value for name in ("alpha0", "width"))
        speed = message.velocity[message.name.index("arm")]
        self.publisher.publish(Float64(data=alpha0 * tanh(speed / width)))


def main() -> None:
    """Run the node until Ctrl-C."""
    rclpy.init()
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(MyObserver())
