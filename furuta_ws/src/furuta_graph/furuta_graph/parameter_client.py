"""What a user does with ``ros2 param``: read and set parameters of running nodes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, ParameterType
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.task import Future

from furuta_ros.errors import UserError

# Longest wait for a node's parameter services or their answer [s].
TIMEOUT = 5.0
ATTEMPTS = 5


class ServiceError(UserError):
    """A node is not there, does not answer, or refuses."""


class ParameterClient:
    """Uses the parameter services of other nodes through ``node``, spun by ``executor``."""

    def __init__(self, node: Node, executor: Executor) -> None:
        self._node = node
        self._executor = executor
        self._clients: dict[str, AsyncParameterClient] = {}

    def set(self, node: str, **values: Any) -> None:
        """Set parameters of one node, all or none. Dots in names are written ``__``."""
        self.set_all(node, {name.replace("__", "."): value for name, value in values.items()})

    def set_all(self, node: str, values: dict[str, Any]) -> None:
        """Set parameters of one node by full name, all or none."""
        parameters = [Parameter(name, value=value) for name, value in values.items()]
        answer: SetParametersAtomically.Response = self._answer(
            node, partial(self._client(node).set_parameters_atomically, parameters)
        )
        if not answer.result.successful:
            raise ServiceError(f"{node} refuses {', '.join(values)}: {answer.result.reason}")

    def get(self, node: str, names: list[str]) -> dict[str, Any]:
        """Values of parameters of one node."""
        answer = self._answer(node, partial(self._client(node).get_parameters, names))
        unset = [value.type == ParameterType.PARAMETER_NOT_SET for value in answer.values]
        if any(unset) or len(unset) != len(names):
            known = set(self.names(node))
            raise ServiceError(
                f"{node} has no parameter {', '.join(n for n in names if n not in known)}"
            )
        values = (parameter_value_to_python(value) for value in answer.values)
        return dict(zip(names, values, strict=True))

    def names(self, node: str) -> list[str]:
        """Names of all parameters of one node."""
        return list(
            self._answer(node, partial(self._client(node).list_parameters, [], 0)).result.names
        )

    def describe(self, node: str, names: list[str]) -> list[ParameterDescriptor]:
        """Descriptors of parameters of one node."""
        return list(
            self._answer(node, partial(self._client(node).describe_parameters, names)).descriptors
        )

    def _client(self, node: str) -> AsyncParameterClient:
        if node not in self._clients:
            client = AsyncParameterClient(self._node, node)
            if not client.wait_for_services(timeout_sec=TIMEOUT):
                raise ServiceError(f"no node {node} answers (waited {TIMEOUT:g} s)")
            self._clients[node] = client
        return self._clients[node]

    def _answer(self, node: str, ask: Callable[[], Future]) -> Any:
        """Ask until there is an answer: the first one can pass before both sides are known.

        Reading and setting twice is the same as once.
        """
        for _ in range(ATTEMPTS):
            future = ask()
            self._executor.spin_until_future_complete(future, timeout_sec=TIMEOUT / ATTEMPTS)
            if future.done():
                return future.result()
        raise ServiceError(f"{node} did not answer within {TIMEOUT:g} s")
