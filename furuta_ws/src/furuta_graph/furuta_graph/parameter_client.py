"""A client of the parameter services of running nodes, as ``ros2 param`` is."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, ParameterType
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.task import Future

from furuta_ros.services import ServiceError, WaitsForFutures, call_service


class ParameterClient:
    """Reads and sets parameters of other nodes, from one thread or from several.

    ``node`` makes the requests and ``executor`` spins it, or waits while another thread does. A
    name without a leading slash is in the namespace of ``node``; ``/left/plant`` is the full name
    of a node in another one. Every method raises :class:`ServiceError` if the other node is missing
    or rejects the request.
    """

    def __init__(self, node: Node, executor: WaitsForFutures) -> None:
        self._node = node
        self._executor = executor
        self._clients: dict[str, AsyncParameterClient] = {}
        self._lock = threading.Lock()

    def set(self, node: str, **values: Any) -> None:
        """Set parameters of one node, all or none. Dots in names are written ``__``."""
        self.set_all(node, {name.replace("__", "."): value for name, value in values.items()})

    def set_all(self, node: str, values: dict[str, Any]) -> None:
        """Set parameters of one node by full name, all or none."""
        parameters = [Parameter(name, value=value) for name, value in values.items()]
        response: SetParametersAtomically.Response = self._call(
            node, partial(self._client(node).set_parameters_atomically, parameters)
        )
        if not response.result.successful:
            raise ServiceError(self._rejection(node, list(values), response.result.reason))

    def _rejection(self, node: str, names: list[str], reason: str) -> str:
        """Why a node rejected parameters; rclpy itself does not name an undeclared one."""
        unknown = sorted(set(names) - set(self.names(node)))
        if unknown and "undeclared" in reason:
            return f"{node} has no parameter {', '.join(unknown)}"
        return f"{node} rejects {', '.join(names)}: {reason}"

    def get(self, node: str, names: list[str]) -> dict[str, Any]:
        """Values of parameters of one node."""
        response = self._call(node, partial(self._client(node).get_parameters, names))
        unset = [value.type == ParameterType.PARAMETER_NOT_SET for value in response.values]
        if any(unset) or len(unset) != len(names):
            known = set(self.names(node))
            raise ServiceError(
                f"{node} has no parameter {', '.join(n for n in names if n not in known)}"
            )
        values = (parameter_value_to_python(value) for value in response.values)
        return dict(zip(names, values, strict=True))

    def names(self, node: str) -> list[str]:
        """Names of all parameters of one node."""
        response = self._call(node, partial(self._client(node).list_parameters, [], 0))
        return list(response.result.names)

    def describe(self, node: str, names: list[str]) -> list[ParameterDescriptor]:
        """Descriptors of parameters of one node; empty if it does not have them all."""
        response = self._call(node, partial(self._client(node).describe_parameters, names))
        return list(response.descriptors)

    def _client(self, node: str) -> AsyncParameterClient:
        with self._lock:
            if node not in self._clients:
                self._clients[node] = AsyncParameterClient(self._node, node)
            return self._clients[node]

    def _call(self, node: str, send: Callable[[], Future]) -> Any:
        wait = self._client(node).wait_for_services
        return call_service(self._executor, node, wait, send, caller=self._node)
