"""The bridge on a test bench: its services, and a loop that answers its measurements."""

from time import monotonic
from typing import Any

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rclpy.parameter import Parameter
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_ros.testing import Bench
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, MEASUREMENT

SETTLING = 500  # samples between holding the pendulum and arming
# Limits that neither a delay of the machine nor the falling pendulum exceeds.
PERMISSIVE_RIG = """
speed: {sensor: encoder}
pendulum: {sensor: encoder}
line: {watchdog: 1.0}
limits:
  {command_age: 10, estimate_age: 10, measurement_age: 10, bad_frames: 1.0, disagreement: 1000,
   pendulum_angle: 3.141592653589793, arm_angle: 1.0e+6, arm_speed: 1.0e+4}
"""


def bridge(bench: Bench, **parameters: Any) -> HardwareBridgeNode:
    """Make a bridge to the mock rig, in the state of its parameter ``autostart``."""
    given = {"port": "mock"} | parameters
    node: HardwareBridgeNode = bench.add(
        HardwareBridgeNode([Parameter(name, value=value) for name, value in given.items()])
    )
    node.start_up()
    return node


def ask(bench: Bench, kind: Any, service: str, request: Any) -> Any:
    """Call a service of the bridge."""
    client = bench.probe.create_client(kind, f"hardware_bridge/{service}")
    assert client.wait_for_service(10.0)
    future = client.call_async(request)
    bench.spin(future.done)
    return future.result()


def change(bench: Bench, transition: int) -> bool:
    """Ask for a transition as ``ros2 lifecycle set`` does."""
    request = ChangeState.Request(transition=Transition(id=transition))
    return bool(ask(bench, ChangeState, "change_state", request).success)


def arm(bench: Bench, armed: bool = True) -> tuple[bool, str]:
    """Ask to arm or to disarm."""
    answer = ask(bench, SetBool, "arm", SetBool.Request(data=armed))
    return answer.success, answer.message


def try_to_arm(bench: Bench) -> tuple[bool, str]:
    """Ask the bridge once to arm; it may not be running."""
    client = bench.probe.create_client(SetBool, "hardware_bridge/arm")
    end = monotonic() + 5.0
    bench.spin(lambda: client.service_is_ready() or monotonic() > end)
    future = client.call_async(SetBool.Request(data=True))
    bench.spin(lambda: future.done() or monotonic() > end)
    if not future.done():
        return False, "no answer"
    return future.result().success, future.result().message


def hold_and_arm(bench: Bench, rig: Any) -> str:
    """Hold the pendulum until the filters have settled, then arm; returns why that failed."""
    held = rig.ask("hold")
    # If a bridge connects in between, the rig counts from zero again.
    bench.spin(lambda: not 0 <= rig.status["sample"] - held["sample"] <= SETTLING)
    armed, message = try_to_arm(bench)
    return "" if armed else f"not armed: {message}"


class Loop:
    """Answers every measurement with a friction estimate and a command."""

    def __init__(self, bench: Bench, command: float) -> None:
        self.command = command
        self.sent: list[float] = []
        self._commands = bench.publisher(COMMAND)
        self._estimates = bench.publisher(FRICTION_ESTIMATE)
        bench.probe.create_subscription(
            MEASUREMENT.message, MEASUREMENT.name, lambda _: self.answer(), 10
        )

    def answer(self) -> None:
        """Answer one sample."""
        self.sent.append(self.command)
        self._estimates.publish(Float64(data=0.0))
        self._commands.publish(Float64(data=self.command))


def driven(bench: Bench, node: HardwareBridgeNode, volts: float) -> Loop:
    """A loop that drives the armed rig with a voltage."""
    loop = Loop(bench, volts)
    spin_samples(bench, node, 100)
    assert arm(bench) == (True, "")
    return loop


def spin_samples(bench: Bench, node: HardwareBridgeNode, count: int) -> None:
    """Spin until the node has published so many samples."""
    end = node.samples + count
    bench.spin(lambda: node.samples >= end)
