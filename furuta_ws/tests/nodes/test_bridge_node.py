"""The bridge as a managed node, on a rig inside its own process."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rclpy.parameter import Parameter
from std_msgs.msg import Float64
from std_srvs.srv import SetBool
from testbench import Bench

from furuta_hw.bridge_node import HardwareBridgeNode
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, MEASUREMENT


def bridge(bench: Bench, **parameters: Any) -> HardwareBridgeNode:
    """A bridge to the mock rig."""
    given = {"port": "mock"} | parameters
    node: HardwareBridgeNode = bench.add(
        HardwareBridgeNode([Parameter(name, value=value) for name, value in given.items()])
    )
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
    """Ask to arm."""
    answer = ask(bench, SetBool, "arm", SetBool.Request(data=armed))
    return answer.success, answer.message


class Loop:
    """Answers every measurement with a friction estimate and a command."""

    def __init__(self, bench: Bench, command: float) -> None:
        self.command = command
        self._commands = bench.publisher(COMMAND)
        self._estimates = bench.publisher(FRICTION_ESTIMATE)
        bench.probe.create_subscription(
            MEASUREMENT.type, MEASUREMENT.name, lambda _: self.answer(), 10
        )

    def answer(self) -> None:
        """One sample."""
        self._estimates.publish(Float64(data=0.0))
        self._commands.publish(Float64(data=self.command))


def code(node: HardwareBridgeNode) -> int:
    """The DA code that the mock rig puts out."""
    assert node.connection is not None
    rig: Any = node.connection._backend
    return int(rig._rig.firmware.code)


def test_states(bench: Bench) -> None:
    """Unconfigured it is deaf; inactive it publishes and cannot be armed; active it can."""
    node = bridge(bench)
    received = bench.collect(MEASUREMENT)
    bench.settle()
    assert (node.state, received) == ("unconfigured", [])
    assert arm(bench) == (False, "the bridge is unconfigured, must be active")
    assert change(bench, Transition.TRANSITION_CONFIGURE)
    bench.spin(lambda: len(received) > 50)
    assert arm(bench) == (False, "the bridge is inactive, must be active")
    Loop(bench, 1.0)
    bench.settle()
    assert code(node) == 0
    assert change(bench, Transition.TRANSITION_ACTIVATE)
    bench.settle()
    assert code(node) == 0  # active is not armed
    bench.spin(lambda: arm(bench)[0] and code(node) != 0)
    assert change(bench, Transition.TRANSITION_DEACTIVATE)
    bench.spin(lambda: code(node) == 0)
    assert not node.guard.armed
    assert change(bench, Transition.TRANSITION_CLEANUP)
    assert (node.state, node.connection) == ("unconfigured", None)


def test_read_only_is_pinned(bench: Bench) -> None:
    """It reads, and refuses to be activated."""
    node = bridge(bench, read_only=True, autostart="active")
    assert node.state == "inactive"
    assert "read_only" in node.trouble
    assert not change(bench, Transition.TRANSITION_ACTIVATE)
    bench.spin(lambda: node.samples > 20)


@pytest.mark.parametrize(
    ("parameters", "reason"),
    [
        ({"port": ""}, "no port given"),
        ({"port": "/dev/nothing"}, "cannot open /dev/nothing: No such file"),
        ({"rig": "missing.yaml"}, "cannot read rig file missing.yaml"),
    ],
)
def test_what_cannot_be_opened_is_said(bench: Bench, parameters: dict, reason: str) -> None:
    """The node stays unconfigured and can be tried again."""
    node = bridge(bench, autostart="active", **parameters)
    assert node.state == "unconfigured"
    assert reason in node.trouble
    assert not change(bench, Transition.TRANSITION_CONFIGURE)


def test_measurements_are_the_rigs(bench: Bench) -> None:
    """Quantised angles, no pendulum speed, the applied torque; stamps a period apart."""
    bridge(bench, autostart="inactive")
    received = bench.collect(MEASUREMENT)
    bench.spin(lambda: len(received) > 100)
    message = received[-1]
    assert message.name == ["arm", "pendulum"]
    assert message.position[1] == pytest.approx(0.05, abs=0.003)
    assert message.velocity[1] != message.velocity[1]
    assert message.effort[0] == 0.0
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in received]
    for earlier, later in pairwise(stamps):
        periods = (later - earlier) / 1e6
        assert round(periods) >= 1
        assert periods == pytest.approx(round(periods), rel=3e-4)


def test_a_bad_command_stops_until_it_is_armed_again(bench: Bench) -> None:
    """NaN: 0 V, one stop with its reason on /diagnostics; explicit arming ends it."""
    node = bridge(bench, autostart="active")
    statuses: list[Any] = []
    bench.probe.create_subscription(DiagnosticArray, "/diagnostics", statuses.append, 100)
    loop = Loop(bench, 0.2)
    bench.spin(lambda: arm(bench)[0] and code(node) != 0)
    loop.command = float("nan")
    bench.spin(lambda: not node.guard.armed and code(node) == 0)
    if "command is nan" in node.guard.reason:  # and not a stall of the machine just before
        bench.spin(lambda: any("command is nan" in s.status[0].message for s in statuses))
        assert statuses[-1].status[0].level == DiagnosticStatus.ERROR
    loop.command = 0.0
    bench.settle()
    assert not node.guard.armed
    stops = node.guard.stops
    bench.spin(lambda: arm(bench)[0])
    assert node.guard.stops >= stops
    assert arm(bench, armed=False) == (True, "disarmed")
    assert not node.guard.armed
