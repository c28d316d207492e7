"""A PID controller that moves the elbow of ``robot.py`` and holds its shoulder.

    tools/in_environment python examples/robot_joint/controller.py --ros-args -p motion:=excite

It adds what arrives on ``/elbow_joint/friction_estimate`` to the elbow's torque. At the end it
prints how well the elbow followed, as one JSON object. Parameters: ``motion`` (excite, sine or
hold), ``seconds``, and ``pid``, the elbow's gains [N m/rad, N m/(rad s), N m s/rad].
"""

import json
import sys
from math import pi, sin
from signal import SIGINT, signal

import numpy as np
import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, Float64MultiArray

JOINTS = ["shoulder_joint", "elbow_joint"]
SHOULDER_PID = [3000.0, 6000.0, 150.0]
CENTRE = np.array([0.5, 0.3])  # of the motion [rad]
START = 2.0  # time [s] in which the joints move to the beginning of the motion
LOST = 0.5  # an estimate of friction that is older [s] does not count


def excite(t: float) -> float:
    """Slow reversals, faster motion every other time, and a stop of 2 s in 10 s."""
    t = 8.0 * (t // 10.0) + min(t % 10.0, 8.0)
    fast = max(sin(2.0 * pi * t / 16.0), 0.0)
    return sin(2.0 * pi * 0.05 * t) + 0.4 * fast * sin(2.0 * pi * 0.9 * t)


MOTIONS = {
    "excite": excite,
    "sine": lambda t: 0.3 * sin(2.0 * pi * 0.1 * t),
    "hold": lambda t: 0.0,
}


class ControllerNode(Node):
    """Answers each joint state with the torques of both joints."""

    def __init__(self) -> None:
        super().__init__("controller")
        motion = self.declare_parameter("motion", "excite").value
        if motion not in MOTIONS:
            sys.exit(f"motion must be one of {', '.join(MOTIONS)}, given {motion}")
        self.motion = MOTIONS[motion]
        self.seconds = self.declare_parameter("seconds", 60.0).value
        elbow = self.declare_parameter("pid", [60.0, 150.0, 5.0]).value
        self.kp, self.ki, self.kd = np.transpose([SHOULDER_PID, elbow])
        self.begin, self.time, self.integral = 0.0, 0.0, np.zeros(2)
        self.friction, self.friction_time = 0.0, -LOST
        self.errors: list[float] = []
        command, estimate = "/effort_controller/commands", "/elbow_joint/friction_estimate"
        self.publisher = self.create_publisher(Float64MultiArray, command, 10)
        self.references = self.create_publisher(JointState, "/reference", 10)
        self.create_subscription(JointState, "/joint_states", self.on_state, 10)
        self.create_subscription(Float64, estimate, self.on_friction, 10)

    def on_friction(self, message: Float64) -> None:
        """Keep the newest estimate of the elbow's friction."""
        self.friction, self.friction_time = message.data, self.time

    def on_state(self, message: JointState) -> None:
        """Answer a state with the torques."""
        joints = [message.name.index(name) for name in JOINTS]
        position = np.array(message.position)[joints]
        velocity = np.array(message.velocity)[joints]
        now = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
        if not self.errors:
            self.begin, self.start = now, position
        dt, self.time = now - self.begin - self.time, now - self.begin
        wanted, speed = self.reference(self.time)
        error = wanted - position
        self.integral += dt * self.ki * error
        torque = self.kp * error + self.integral + self.kd * (speed - velocity)
        if self.time - self.friction_time < LOST:
            torque[1] += self.friction
        self.publisher.publish(Float64MultiArray(data=torque.tolist()))
        reference = JointState(name=JOINTS, position=wanted.tolist(), velocity=speed.tolist())
        reference.header.stamp = message.header.stamp
        self.references.publish(reference)
        self.errors.append(error[1])

    def reference(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Positions [rad] and speeds [rad/s] to follow; at first they lead to the motion."""
        h, part = 1e-3, 1.0 - max(1.0 - t / START, 0.0) ** 2
        goal = CENTRE + np.array([0.0, self.motion(t)])
        speed = (self.motion(t + h) - self.motion(t - h)) / (2.0 * h)
        return self.start + part * (goal - self.start), np.array([0.0, part * speed])

    def summary(self) -> dict[str, float]:
        """How well the elbow followed in the second half [rad]."""
        error = np.array(self.errors[len(self.errors) // 2 :])
        return {
            "error_rms_rad": float(np.sqrt(np.mean(error**2))),
            "error_max_rad": float(np.max(np.abs(error))),
            "peak_to_peak_rad": float(np.ptp(error)),
        }


def main() -> None:
    """Control the arm for a while, or until Ctrl-C."""
    ended: list[object] = []
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # its handler ends within callbacks
    signal(SIGINT, lambda *_: ended.append(None))
    node, executor = ControllerNode(), EventsExecutor()
    executor.add_node(node)
    while node.time < node.seconds and not ended:
        executor.spin_once(timeout_sec=0.1)
    if node.errors:
        print(json.dumps(node.summary()))
    rclpy.shutdown()


if __name__ == "__main__":
    main()
