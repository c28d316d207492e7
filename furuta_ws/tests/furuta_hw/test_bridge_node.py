"""The bridge as a managed node, on an emulated rig in its own process."""

from itertools import pairwise
from math import isnan
from pathlib import Path
from typing import Any

import pytest
from bridge_bench import PERMISSIVE_RIG, Loop, arm, ask, bridge, change, driven, spin_samples
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rclpy.node import Node

from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_hw.connection import rig_connection
from furuta_ros.node import LATCHED, QOS
from furuta_ros.testing import Bench
from furuta_ros.topics import ARMED, COMMAND, MEASUREMENT


@pytest.fixture
def permissive_rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A rig file whose limits stop nothing; a delay of the machine is no silent rig either."""
    monkeypatch.setattr(rig_connection, "RETRY_PERIOD", 60.0)
    file = tmp_path / "rig.yaml"
    file.write_text(PERMISSIVE_RIG)
    return str(file)


def code(node: HardwareBridgeNode) -> int:
    """The DA code that the mock rig puts out."""
    assert node.connection is not None
    driver: Any = node.connection._driver
    return int(driver._port._rig.firmware.code)


def test_states(bench: Bench, permissive_rig: str, capfd: Any) -> None:
    """Unconfigured it does nothing; inactive it publishes; active it can be armed and drives."""
    node = bridge(bench, rig=permissive_rig)
    received = bench.collect(MEASUREMENT)
    assert arm(bench) == (False, "the bridge is unconfigured, must be active")
    assert (node.state, received) == ("unconfigured", [])
    assert change(bench, Transition.TRANSITION_CONFIGURE)
    bench.spin(lambda: len(received) > 50)
    assert arm(bench) == (False, "the bridge is inactive, must be active")
    Loop(bench, 1.0)
    spin_samples(bench, node, 100)
    assert code(node) == 0
    assert change(bench, Transition.TRANSITION_ACTIVATE)
    spin_samples(bench, node, 100)
    assert code(node) == 0  # an active bridge is not armed
    assert arm(bench) == (True, "")
    bench.spin(lambda: code(node) != 0)
    assert change(bench, Transition.TRANSITION_DEACTIVATE)
    bench.spin(lambda: code(node) == 0)
    assert (node.guard.armed, node.guard.reason) == (False, "deactivated")
    assert node.summary().endswith(" 0 stops")
    assert "ERROR" not in (log := capfd.readouterr().err)
    assert "0 V: deactivated" in log
    assert change(bench, Transition.TRANSITION_CLEANUP)
    assert (node.state, node.connection) == ("unconfigured", None)


def test_stops_are_counted_since_the_start(bench: Bench, permissive_rig: str) -> None:
    """Also those before the bridge was configured anew."""
    node = bridge(bench, rig=permissive_rig, autostart="active")
    Loop(bench, 1.0)
    spin_samples(bench, node, 100)
    assert arm(bench) == (True, "")
    node.guarded_rig.stop("test")
    for transition in (Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_CLEANUP):
        assert change(bench, transition)
    assert change(bench, Transition.TRANSITION_CONFIGURE)
    assert node.summary().endswith(" 1 stops")


def test_a_transition_that_the_state_does_not_have(bench: Bench, capfd: Any) -> None:
    """It is refused with a warning: somebody was mistaken, the bridge is not at fault."""
    node = bridge(bench, autostart="active")
    for wrong, named in (
        (Transition(id=Transition.TRANSITION_ACTIVATE), "3"),
        (Transition(id=99), "99"),
        (Transition(label="activate"), "'activate'"),
    ):
        request = ChangeState.Request(transition=wrong)
        assert not ask(bench, ChangeState, "change_state", request).success
        log = capfd.readouterr().err
        assert f"no transition {named} while active; possible: deactivate, shutdown" in log
        assert "ERROR" not in log
    request = ChangeState.Request(transition=Transition(label="deactivate"))
    assert ask(bench, ChangeState, "change_state", request).success
    assert node.state == "inactive"


def test_reports_whether_it_is_armed(bench: Bench, permissive_rig: str) -> None:
    """A subscriber that comes late knows it, and every change."""
    node = bridge(bench, rig=permissive_rig, autostart="active")
    reports: list[bool] = []
    bench.probe.create_subscription(
        ARMED.message, ARMED.name, lambda message: reports.append(message.data), LATCHED
    )
    bench.spin(lambda: reports == [False])
    driven(bench, node, 1.0)
    bench.spin(lambda: reports == [False, True])
    node.guarded_rig.stop("test")
    bench.spin(lambda: reports == [False, True, False])


def test_a_second_controller_stops_the_rig_and_keeps_it_from_arming(
    bench: Bench, permissive_rig: str
) -> None:
    """Nobody can say whose commands are right; the reason names both."""
    node = bridge(bench, rig=permissive_rig, autostart="active")
    driven(bench, node, 1.0)
    bench.spin(lambda: code(node) != 0)
    second = Node("second")
    publisher = second.create_publisher(COMMAND.message, COMMAND.name, QOS)
    bench.spin(lambda: not node.guard.armed)
    assert node.guard.reason == "2 nodes publish command: /probe and /second"
    bench.spin(lambda: code(node) == 0)
    assert arm(bench) == (False, "2 nodes publish command: /probe and /second")
    second.destroy_publisher(publisher)
    second.destroy_node()
    bench.spin(lambda: arm(bench) == (True, ""))


def test_a_read_only_bridge_cannot_be_activated(bench: Bench) -> None:
    """It reads, and rejects the transition."""
    node = bridge(bench, read_only=True, autostart="active")
    assert node.state == "inactive"
    assert "read_only" in node.failure
    assert not change(bench, Transition.TRANSITION_ACTIVATE)
    bench.spin(lambda: node.samples > 20)


@pytest.mark.parametrize(
    ("parameters", "reason"),
    [
        ({"port": "/dev/nothing"}, "cannot open /dev/nothing: No such file"),
        ({"rig": "missing.yaml"}, "cannot read rig file missing.yaml"),
    ],
)
def test_a_failed_configuration_has_a_reason(
    bench: Bench, parameters: dict[str, str], reason: str
) -> None:
    """The node stays unconfigured, and the transition can be tried again."""
    node = bridge(bench, autostart="active", **parameters)
    assert node.state == "unconfigured"
    assert reason in node.failure
    assert not change(bench, Transition.TRANSITION_CONFIGURE)


def test_measurements_are_those_of_the_rig(bench: Bench) -> None:
    """Quantised angles, no pendulum speed, the applied voltage; stamps a period apart."""
    bridge(bench, autostart="inactive")
    received = bench.collect(MEASUREMENT)
    bench.spin(lambda: len(received) > 100)
    message = received[-1]
    assert message.name == ["arm", "pendulum"]
    assert message.position[1] == pytest.approx(0.05, abs=0.003)
    assert isnan(message.velocity[1])
    assert message.effort[0] == 0.0
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in received]
    for earlier, later in pairwise(stamps):
        periods = (later - earlier) / 1e6
        assert round(periods) >= 1
        assert periods == pytest.approx(round(periods), rel=3e-4)


def test_a_bad_command_stops_the_rig_until_it_is_armed_again(
    bench: Bench, permissive_rig: str
) -> None:
    """NaN: 0 V, one stop with its reason on /diagnostics, until the bridge is armed explicitly."""
    node = bridge(bench, rig=permissive_rig, autostart="active")
    statuses: list[Any] = []
    bench.probe.create_subscription(DiagnosticArray, "/diagnostics", statuses.append, 100)
    loop = driven(bench, node, 0.2)
    bench.spin(lambda: code(node) != 0)
    loop.command = float("nan")
    bench.spin(lambda: not node.guard.armed and code(node) == 0)
    assert (node.guard.reason, node.guard.stops) == ("command is nan", 1)
    stopped = (DiagnosticStatus.ERROR, "command is nan")
    bench.spin(lambda: stopped in [(s.status[0].level, s.status[0].message) for s in statuses])
    loop.command = 0.0
    spin_samples(bench, node, 100)  # a busy computer may drop some of the commands
    assert 0 < node.refused <= sum(map(isnan, loop.sent))
    assert (node.guard.armed, node.guard.stops) == (False, 1)
    assert arm(bench) == (True, "")
    spin_samples(bench, node, 100)
    assert (node.guard.armed, node.guard.stops) == (True, 1)
    assert arm(bench, armed=False) == (True, "disarmed")
    assert (node.guard.armed, node.guard.stops) == (False, 1)  # which is no stop
    status = node.status()
    assert (status.level, status.message) == (DiagnosticStatus.WARN, "disarmed by request")


@pytest.mark.parametrize("allowed", [False, True])
def test_commands_from_the_network(
    bench: Bench, permissive_rig: str, monkeypatch: pytest.MonkeyPatch, allowed: bool
) -> None:
    """A bridge that other machines can discover is armed only if that was asked for."""
    node = bridge(bench, rig=permissive_rig, autostart="active", network_commands=allowed)
    Loop(bench, 0.0)
    spin_samples(bench, node, 10)
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    success, message = arm(bench)
    assert success == allowed, message
    assert ("other machines can send commands" in message) != allowed
    assert ("set the parameter network_commands" in message) != allowed
    assert node.guard.armed == allowed
