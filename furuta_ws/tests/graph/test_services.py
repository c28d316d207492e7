"""How many changes of parameters a node accepts, and what a call of a missing node says."""

import pytest
from rclpy.node import Node
from std_srvs.srv import Trigger

from furuta_bringup.graph.services import ServiceCaller, ServiceError
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
    with pytest.raises(ServiceError, match="no node is running"):
        caller.call("plant", "reset", Trigger, Trigger.Request(), timeout=0.1)
    bench.add(Node("other"))
    with pytest.raises(ServiceError, match="nodes are /other$"):
        caller.call("plant", "reset", Trigger, Trigger.Request(), timeout=0.1)
