"""An emulated arm with two joints in a vertical plane, with the topics of a robot.

    tools/in_environment python examples/robot_joint/robot.py    # Ctrl-C ends it

It publishes ``/joint_states`` at 500 Hz and takes torques from ``/effort_controller/commands``, as
the effort controllers of ros2_control do. Brakes hold it until a command comes. Body and friction
are its own: nothing of this workspace is in it.
"""

from array import array
from math import pi
from signal import SIGINT, signal
from typing import NamedTuple

import numpy as np
import rclpy
from numba import njit
from rclpy.duration import Duration
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

JOINTS = ("shoulder_joint", "elbow_joint")
SAMPLE, STEPS = 0.002, 20  # [s], steps of the simulation in a sample
COUNT, TORQUE_STEP = 2.0 * pi / 2**16, 0.02  # of the encoders [rad] and of the drives [N m]
LARGEST_TORQUE = np.array([150.0, 40.0])  # [N m]
FILTER_TIME = 0.004  # of the published velocity [s]
PATIENCE = 50  # samples without a command after which the brakes close


class Arm(NamedTuple):
    """The arm [kg, m, kg m², N m, rad/s]; pairs are shoulder and elbow.

    ``inertia`` is that of a link about its centre, ``rotor`` that of a motor behind its gear.
    Friction is coulomb + stiction exp(-|v| / fall) + load times the torque in the gear.
    """

    mass: tuple[float, float] = (4.0, 2.5)
    centre: tuple[float, float] = (0.18, 0.25)
    length: float = 0.4
    inertia: tuple[float, float] = (0.06, 0.03)
    rotor: tuple[float, float] = (0.5, 0.12)
    coulomb: tuple[float, float] = (6.0, 2.0)
    stiction: tuple[float, float] = (3.0, 1.2)
    fall: tuple[float, float] = (0.05, 0.05)
    viscous: tuple[float, float] = (3.0, 0.9)
    load: tuple[float, float] = (0.02, 0.02)
    brake: float = 0.0
    gravity: float = 9.81


ARM, BRAKE = Arm(), 200.0


@njit
def move(q: np.ndarray, v: np.ndarray, torque: np.ndarray, h: float, steps: int, arm: Arm) -> None:
    """Move angles and speeds (2,) by steps of ``h`` [s] under a constant torque (2,).

    Friction is the impulse, at most h times its level, that brings a joint to rest or as near to
    it as it can. The two joints' impulses are found in turns.
    """
    own = arm.mass[1] * arm.centre[1] ** 2 + arm.inertia[1]
    far = arm.mass[0] * arm.centre[0] ** 2 + arm.mass[1] * arm.length**2
    far, m22 = far + arm.inertia[0] + arm.rotor[0], own + arm.rotor[1]
    impulse, most = np.zeros(2), np.zeros(2)
    for _ in range(steps):
        cosine = arm.mass[1] * arm.length * arm.centre[1] * np.cos(q[1])
        sine = arm.mass[1] * arm.length * arm.centre[1] * np.sin(q[1])
        m11, m12 = far + own + 2.0 * cosine, own + cosine
        weight = arm.mass[1] * arm.centre[1] * np.cos(q[0] + q[1])
        upper = (arm.mass[0] * arm.centre[0] + arm.mass[1] * arm.length) * np.cos(q[0])
        first = torque[0] - arm.gravity * (upper + weight) - arm.viscous[0] * v[0]
        first += sine * v[1] * (2.0 * v[0] + v[1])
        second = torque[1] - arm.gravity * weight - arm.viscous[1] * v[1] - sine * v[0] ** 2
        determinant = m11 * m22 - m12**2
        a, b, c = m22 / determinant, -m12 / determinant, m11 / determinant
        for k in range(2):
            level = arm.coulomb[k] + arm.stiction[k] * np.exp(-abs(v[k]) / arm.fall[k])
            most[k] = h * (level + arm.load[k] * abs(torque[k]) + arm.brake)
        v[0], v[1] = v[0] + h * (a * first + b * second), v[1] + h * (b * first + c * second)
        impulse[:] = 0.0
        for _ in range(20):
            for k in range(2):
                wanted = impulse[k] + v[k] / (a if k == 0 else c)
                change = min(max(wanted, -most[k]), most[k]) - impulse[k]
                impulse[k] += change
                v[0] -= change * (a if k == 0 else b)
                v[1] -= change * (b if k == 0 else c)
        for k in range(2):
            if abs(impulse[k]) < most[k]:
                v[k] = 0.0
            q[k] += h * v[k]


class Robot:
    """The arm with drives and encoders, one sample after the other."""

    def __init__(self, arm: Arm = ARM) -> None:
        self.arm = arm
        self.angle, self.speed = np.array([0.5, -0.8]), np.zeros(2)
        self.torque, self.velocity = np.zeros(2), np.zeros(2)
        self.position = COUNT * np.round(self.angle / COUNT)

    def sample(self, torque: np.ndarray, brakes: bool) -> tuple[np.ndarray, ...]:
        """Move for a sample; then take the torque of the next one, or close the brakes.

        Returns the measured positions, velocities and efforts. An effort is the torque so far.
        """
        effort = self.torque.copy()
        move(self.angle, self.speed, effort, SAMPLE / STEPS, STEPS, self.arm)
        before, self.position = self.position, COUNT * np.round(self.angle / COUNT)
        difference = (self.position - before) / SAMPLE
        self.velocity = self.velocity + SAMPLE / FILTER_TIME * (difference - self.velocity)
        self.arm = self.arm._replace(brake=BRAKE * brakes)
        limited = np.clip(torque * (not brakes), -LARGEST_TORQUE, LARGEST_TORQUE)
        self.torque = TORQUE_STEP * np.round(limited / TORQUE_STEP)
        return self.position, self.velocity, effort


class RobotNode(Node):
    """Runs the robot in real time, or slower if the computer is busy; the stamps stay even."""

    def __init__(self) -> None:
        super().__init__("robot")
        self.robot, self.torque, self.waited = Robot(), np.zeros(2), PATIENCE
        self.stamp = self.get_clock().now()
        self.message = JointState(name=JOINTS)
        self.publisher = self.create_publisher(JointState, "/joint_states", 10)
        topic = "/effort_controller/commands"
        self.create_subscription(Float64MultiArray, topic, self.on_command, 10)
        self.create_timer(SAMPLE, self.on_time)

    def on_command(self, message: Float64MultiArray) -> None:
        """Keep the newest command, if it is a number for each joint."""
        torque = np.array(message.data)
        if torque.shape == (2,) and np.all(np.isfinite(torque)):
            self.torque, self.waited = torque, 0

    def on_time(self) -> None:
        """Publish a sample."""
        self.waited += 1
        state = self.robot.sample(self.torque, brakes=self.waited > PATIENCE)
        self.message.position, self.message.velocity, self.message.effort = (
            array("d", values) for values in state
        )
        self.message.header.stamp = self.stamp.to_msg()
        self.publisher.publish(self.message)
        self.stamp += Duration(seconds=SAMPLE)


def main() -> None:
    """Run the robot until Ctrl-C."""
    ended: list[object] = []
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # its handler ends within callbacks
    signal(SIGINT, lambda *_: ended.append(None))
    Robot().sample(np.zeros(2), brakes=True)  # compiles
    node, executor = RobotNode(), EventsExecutor()
    executor.add_node(node)
    while not ended:
        executor.spin_once(timeout_sec=0.1)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
