"""Which response to a repeated request counts."""

from __future__ import annotations

from typing import Any

import pytest
from rclpy.task import Future

from furuta_bringup.graph.services import ServiceCaller, ServiceError
from furuta_ros.parameter_service import BURST, RATE, Allowance


class SlowNode:
    """A node, its client and its executor; answers each request after ``delay`` further ones."""

    def __init__(self, delay: int, failure: Exception | None = None, present: bool = True) -> None:
        self.delay, self.failure, self.present = delay, failure, present
        self.sent: list[Future] = []

    def create_client(self, kind: Any, name: str) -> SlowNode:
        """A client of a service."""
        return self

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """All nodes."""
        return [("slow", "/left")]

    def get_name(self) -> str:
        """The caller itself."""
        return "caller"

    def wait_for_service(self, timeout: float) -> bool:
        """Whether the service is there."""
        return self.present

    def call_async(self, request: Any) -> Future:
        """Send a request."""
        self.sent.append(Future())
        return self.sent[-1]

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Answer the request that is old enough."""
        answered = len(self.sent) - 1 - self.delay
        if answered >= 0 and self.failure:
            self.sent[answered].set_exception(self.failure)
        elif answered >= 0:
            self.sent[answered].set_result(f"to request {answered}")

    def call(self, **options: int) -> object:
        """Call the service."""
        node: Any = self
        return ServiceCaller(node, node).call("slow", "service", None, None, **options)


@pytest.mark.parametrize("delay", [0, 19])
def test_late_response_counts(delay: int) -> None:
    """A node that takes longer than the time between two requests is not a node that is silent."""
    assert SlowNode(delay).call() == "to request 0"


def test_silent_node() -> None:
    """After all attempts, or after one if the request must not be repeated."""
    node = SlowNode(delay=20)
    with pytest.raises(ServiceError, match="slow did not answer within 20 s"):
        node.call()
    assert len(node.sent) == 20
    with pytest.raises(ServiceError, match="did not answer"):
        node.call(attempts=1)
    assert len(node.sent) == 21


def test_missing_node() -> None:
    """Nothing is sent to a service that is not there; nodes of that name elsewhere are named."""
    node = SlowNode(0, present=False)
    reason = r"no node slow answers .* in other namespaces: /left/sl"
    with pytest.raises(ServiceError, match=reason):
        node.call()
    assert not node.sent


def test_changes_of_parameters_are_limited() -> None:
    """A burst at once, and then as many as the rate permits, so that samples go on."""
    now = [0.0]
    allowance = Allowance(lambda: now[0])
    assert sum(allowance.take() for _ in range(1000)) == BURST
    now[0] += 5.0 / RATE
    assert [allowance.take() for _ in range(6)] == [True] * 5 + [False]
