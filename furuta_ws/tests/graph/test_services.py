"""How many changes of parameters a node accepts; what clients say of nodes and ask of them."""

from typing import Any

import pytest
from bridge_bench import bridge
from rclpy.node import Node
from std_srvs.srv import Trigger

from furuta_bringup.graph.services import ServiceCaller, ServiceError
from furuta_bringup.graph.system_client import BridgeClient
from furuta_ros.parameters import BURST, RATE, Allowance
from furuta_ros.testing import Bench


def test_changes_of_parameters_are_limited() -> None:
    """A burst at once, and then as many as the rate permits, so that samples go on."""
    now = [0.0]
    allowance = Allowance(lambda: now[0])
    assert sum(allowance.take() for _ in range(1000)) == BURST
    now[0] += 5.0 / RATE
    assert [allowance.take() for _ in range(6)] == [True] * 5 + [False]


def test_hidden_nodes_are_not_listed(bench: Bench) -> None:
    """The daemon that ros2 leaves behind is no node to call."""
    caller = ServiceCaller(bench.probe, bench.executor)
    bench.add(Node("_ros2cli_daemon_0"))
    bench.add(Node("other"))
    # ROS may still remember nodes of earlier tests.
    with pytest.raises(ServiceError, match=r"nodes are .*/other") as refused:
        caller.call("plant", "reset", Trigger, Trigger.Request(), timeout=0.1)
    assert "daemon" not in str(refused.value)


def test_a_bridge_that_is_already_there_is_not_asked(bench: Bench, capfd: Any) -> None:
    """``furuta hw state activate`` leaves no warning on an active bridge."""
    node = bridge(bench, autostart="active")
    BridgeClient(bench.probe, bench.executor).change_state("activate")
    assert node.state == "active"
    assert capfd.readouterr().err == ""
