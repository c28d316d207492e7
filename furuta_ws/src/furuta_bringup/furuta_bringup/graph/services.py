"""Calls of services of other nodes, repeated until there is a response."""

import threading
from functools import partial
from typing import Any

from rclpy.client import Client
from rclpy.node import Node
from rclpy.task import Future

from furuta_model.parameters import suggestion
from furuta_ros.errors import UserError

# Longest wait for a service [s].
TIMEOUT = 5.0
# Longest wait for a response [s], and how often the request is sent. A process that gets the port
# of one that was just killed has to wait until the others have forgotten that one, which takes more
# than 10 s on a busy machine.
ANSWER_TIMEOUT = 20.0
ATTEMPTS = 20


class ServiceError(UserError):
    """A node is missing, does not respond, or rejects a request."""


class ServiceCaller:
    """Calls services of other nodes, from one thread or from several.

    ``node`` makes the requests and ``executor`` spins it, or waits while another thread does: an
    executor of rclpy, or a :class:`furuta_bringup.page.graph_link.SpinningThread`.
    """

    def __init__(self, node: Node, executor: Any) -> None:
        self._node, self._executor = node, executor
        self._clients: dict[str, Client] = {}
        self._lock = threading.Lock()

    def call(
        self,
        node: str,
        service: str,
        kind: Any,
        request: Any,
        timeout: float = TIMEOUT,
        attempts: int = ATTEMPTS,
    ) -> Any:
        """The response of ``service``, of type ``kind``, of another node.

        A name without a leading slash is in the namespace of this node. The first response can get
        lost before both sides know each other, so the request is sent ``attempts`` times: more than
        once only if it may be repeated. The first response counts, whichever request it answers: on
        a busy machine each takes longer than the time until the next.

        Raises:
            ServiceError: No such service within ``timeout`` [s], or no response in time.
        """
        client = self._client(kind, f"{node}/{service}")
        if not client.wait_for_service(timeout):
            raise ServiceError(
                f"no node {node} answers (waited {timeout:g} s); {self._other_nodes(node)}"
            )
        answered = Future()
        for _ in range(attempts):
            client.call_async(request).add_done_callback(partial(_pass_on, answered))
            self._executor.spin_until_future_complete(answered, ANSWER_TIMEOUT / attempts)
            if answered.done():
                return answered.result()
        raise ServiceError(f"{node} did not answer within {ANSWER_TIMEOUT:g} s")

    def _client(self, kind: Any, name: str) -> Client:
        with self._lock:
            if name not in self._clients:
                self._clients[name] = self._node.create_client(kind, name)
            return self._clients[name]

    def _other_nodes(self, node: str) -> str:
        """The nodes of this name in all namespaces, or else all that run.

        Names of hidden nodes, such as the daemon of ros2, begin with ``_``.
        """
        bare = node.rpartition("/")[2]
        names = sorted(
            f"{namespace.rstrip('/')}/{name}"
            for name, namespace in self._node.get_node_names_and_namespaces()
            if name != self._node.get_name() and not name.startswith("_")
        )
        same = [name for name in names if name.endswith(f"/{bare}")]
        if same:
            return f"in other namespaces: {', '.join(same)} (--namespace)"
        near = suggestion(bare, (name.rpartition("/")[2] for name in names))
        return f"nodes are {', '.join(names)}{near}" if names else "no node is running"


def _pass_on(answered: Future, response: Future) -> None:
    """Keep the first response, or the first failure."""
    if answered.done():
        return
    failure = response.exception()
    if failure is not None:
        answered.set_exception(failure)
    else:
        answered.set_result(response.result())
