"""Service calls that are repeated until there is a response."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

from rclpy.node import Node
from rclpy.task import Future

from furuta_ros.errors import UserError

# Longest wait for a service [s].
TIMEOUT = 5.0
# Longest wait for a response [s], and how often the request is sent. A process that starts soon
# after another was killed takes its port, and the middleware needs some seconds to notice.
ANSWER_TIMEOUT = 10.0
ATTEMPTS = 10


class ServiceError(UserError):
    """A node is missing, does not respond, or rejects a request."""


class WaitsForFutures(Protocol):
    """An executor, or what waits while another thread spins one."""

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Return when ``future`` is done or the time is up."""


def call_service(
    executor: WaitsForFutures,
    node: str,
    wait: Callable[[float], bool],
    send: Callable[[], Future],
    timeout: float = TIMEOUT,
    attempts: int = ATTEMPTS,
    caller: Node | None = None,
) -> Any:
    """The response of a service of ``node``; the executor spins until it arrives.

    ``wait(seconds)`` waits for the service and returns whether it is there; ``send()`` sends the
    request. The first response can get lost before both sides know each other, so the request is
    sent ``attempts`` times: more than once only if it may be repeated. The first response counts,
    whichever request it answers: on a busy machine each takes longer than the time until the next.
    If the node is missing, the error names nodes of that name in the other namespaces that the node
    ``caller`` sees.

    Raises:
        ServiceError: No such service within ``timeout`` [s], or no response in time.
    """
    if not wait(timeout):
        elsewhere = _nodes_elsewhere(caller, node) if caller else ""
        raise ServiceError(f"no node {node} answers (waited {timeout:g} s){elsewhere}")
    answered = Future()
    for _ in range(attempts):
        send().add_done_callback(partial(_pass_on, answered))
        executor.spin_until_future_complete(answered, timeout_sec=ANSWER_TIMEOUT / attempts)
        if answered.done():
            return answered.result()
    raise ServiceError(f"{node} did not answer within {ANSWER_TIMEOUT:g} s")


def _nodes_elsewhere(caller: Node, node: str) -> str:
    """The end of a sentence that names the nodes of this name in all namespaces."""
    name = node.rpartition("/")[2]
    found = sorted(
        f"{namespace.rstrip('/')}/{each}"
        for each, namespace in caller.get_node_names_and_namespaces()
        if each == name
    )
    return f"; in other namespaces: {', '.join(found)} (--namespace)" if found else ""


def _pass_on(answered: Future, response: Future) -> None:
    """Keep the first response, or the first failure."""
    if answered.done():
        return
    failure = response.exception()
    if failure is not None:
        answered.set_exception(failure)
    else:
        answered.set_result(response.result())
