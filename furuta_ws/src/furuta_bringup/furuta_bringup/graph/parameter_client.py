"""A client of the parameter services of running nodes, as ``ros2 param`` is."""

from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, ParameterType
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    SetParametersAtomically,
)
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python

from furuta.settings.nodes import NODES
from furuta_bringup.graph.services import ServiceCaller, ServiceError
from furuta_model.parameters import declared, suggestion


class ParameterClient:
    """Reads and sets parameters of other nodes, from one thread or from several.

    A name without a leading slash is in the namespace of ``node``; ``/left/plant`` is the full name
    of a node in another one. Every method raises :class:`ServiceError` if the other node is missing
    or rejects the request.
    """

    def __init__(self, node: Node, executor: Any) -> None:
        self._services = ServiceCaller(node, executor)

    def set(self, node: str, **values: Any) -> None:
        """Set parameters of one node, all or none. Dots in names are written ``__``."""
        self.set_all(node, {name.replace("__", "."): value for name, value in values.items()})

    def set_all(self, node: str, values: dict[str, Any]) -> None:
        """Set parameters of one node by full name, all or none."""
        parameters = [Parameter(name, value=v).to_parameter_msg() for name, v in values.items()]
        request = SetParametersAtomically.Request(parameters=parameters)
        response = self._services.call(
            node, "set_parameters_atomically", SetParametersAtomically, request
        )
        if not response.result.successful:
            raise ServiceError(self._rejection(node, values, response.result.reason))

    def _rejection(self, node: str, values: dict[str, Any], reason: str) -> str:
        """Why a node rejected parameters, with a suggestion for each undeclared one."""
        unknown = self._unknown(node, list(values))
        if unknown and "undeclared" in reason:
            return unknown
        _, is_fixed, fixed = reason.partition("read-only parameter: ")
        if is_fixed:
            name, described = fixed.rstrip("."), NODES.get(node.rpartition("/")[2])
            ours = [each.name for each in declared(described.parameters)] if described else []
            remedy = f": furuta run --set {name}={values[name]}" if name in ours else ""
            return f"{node}.{name} is fixed at start{remedy}"
        return f"{node} rejects {', '.join(values)}: {reason}"

    def _unknown(self, node: str, names: list[str]) -> str:
        """Which of the names a node does not have, and what is like them; empty if it has all."""
        known = self.names(node)
        unknown = [name + suggestion(name, known) for name in names if name not in known]
        return f"{node} has no parameter {', '.join(unknown)}" if unknown else ""

    def get(self, node: str, names: list[str]) -> dict[str, Any]:
        """Values of parameters of one node."""
        request = GetParameters.Request(names=names)
        response = self._services.call(node, "get_parameters", GetParameters, request)
        unset = [value.type == ParameterType.PARAMETER_NOT_SET for value in response.values]
        if any(unset) or len(unset) != len(names):
            raise ServiceError(self._unknown(node, names))
        values = (parameter_value_to_python(value) for value in response.values)
        return dict(zip(names, values, strict=True))

    def names(self, node: str) -> list[str]:
        """Names of all parameters of one node."""
        request = ListParameters.Request()
        response = self._services.call(node, "list_parameters", ListParameters, request)
        return list(response.result.names)

    def describe(self, node: str, names: list[str]) -> list[ParameterDescriptor]:
        """Descriptors of parameters of one node; empty if it does not have them all."""
        request = DescribeParameters.Request(names=names)
        response = self._services.call(node, "describe_parameters", DescribeParameters, request)
        return list(response.descriptors)
