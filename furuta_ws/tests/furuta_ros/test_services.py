"""Which response to a repeated request counts."""

from __future__ import annotations

import pytest
from rclpy.task import Future

from furuta_ros.services import ServiceError, call_service


class SlowNode:
    """Answers each request after ``delay`` further requests."""

    def __init__(self, delay: int, failure: Exception | None = None) -> None:
        self.delay, self.failure = delay, failure
        self.sent: list[Future] = []

    def send(self) -> Future:
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
        return call_service(self, "slow", lambda timeout: True, self.send, **options)


@pytest.mark.parametrize("delay", [0, 1, 9])
def test_late_response_counts(delay: int) -> None:
    """A node that takes longer than the time between two requests is not a node that is silent."""
    assert SlowNode(delay).call() == "to request 0"


def test_silent_node() -> None:
    """After all attempts."""
    node = SlowNode(delay=10)
    with pytest.raises(ServiceError, match="slow did not answer within 10 s"):
        node.call()
    assert len(node.sent) == 10


def test_request_that_must_not_be_repeated() -> None:
    """It is sent once, even if nobody answers."""
    node = SlowNode(delay=1)
    with pytest.raises(ServiceError, match="did not answer"):
        node.call(attempts=1)
    assert len(node.sent) == 1


def test_failed_call() -> None:
    """Its exception is the caller's."""
    with pytest.raises(ValueError, match="no such type"):
        SlowNode(1, ValueError("no such type")).call()


def test_missing_node() -> None:
    """Nothing is sent to a service that is not there."""
    node = SlowNode(0)
    with pytest.raises(ServiceError, match="no node slow answers"):
        call_service(node, "slow", lambda timeout: False, node.send)
    assert not node.sent
