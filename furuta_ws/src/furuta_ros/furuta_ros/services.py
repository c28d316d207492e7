"""Service calls that are repeated until there is a response."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.executors import Executor
from rclpy.task import Future

from furuta_ros.errors import UserError

# Longest wait for a service or for its response [s], and how often the request is sent.
TIMEOUT = 5.0
ATTEMPTS = 5


class ServiceError(UserError):
    """A node is missing, does not respond, or rejects a request."""


def call_service(
    executor: Executor,
    node: str,
    wait: Callable[[float], bool],
    send: Callable[[], Future],
    timeout: float = TIMEOUT,
) -> Any:
    """The response of a service of ``node``; the executor spins until it arrives.

    ``wait(seconds)`` waits for the service and returns whether it is there; ``send()`` sends the
    request. The first response can get lost before both sides know each other, so the request is
    sent again: use this only for requests that may be repeated.

    Raises:
        ServiceError: No such service, or no response, within ``timeout`` [s].
    """
    if not wait(timeout):
        raise ServiceError(f"no node {node} answers (waited {timeout:g} s)")
    for _ in range(ATTEMPTS):
        future = send()
        executor.spin_until_future_complete(future, timeout_sec=timeout / ATTEMPTS)
        if future.done():
            return future.result()
    raise ServiceError(f"{node} did not answer within {timeout:g} s")
