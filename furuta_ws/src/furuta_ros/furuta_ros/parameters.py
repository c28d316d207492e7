"""ROS parameters of a node from a declared group of parameters (furuta_model.parameters)."""

import math
from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.node import Node
from rclpy.parameter import Parameter

from furuta_model.parameters import Declared, ParameterError, build, declared
from furuta_ros.context import ros_arguments
from furuta_ros.parameter_sections import check_names, read_sections

Group = TypeVar("Group", bound=NamedTuple)

_TYPES = {
    float: Parameter.Type.DOUBLE,
    int: Parameter.Type.INTEGER,
    bool: Parameter.Type.BOOL,
    str: Parameter.Type.STRING,
    list: Parameter.Type.DOUBLE_ARRAY,
}
_LISTS = {
    Parameter.Type.BYTE_ARRAY,
    Parameter.Type.BOOL_ARRAY,
    Parameter.Type.INTEGER_ARRAY,
    Parameter.Type.DOUBLE_ARRAY,
    Parameter.Type.STRING_ARRAY,
}


class NodeParameters(Generic[Group]):
    """A node's parameters as one immutable tuple, ``current``.

    A change is validated as a whole. If it is valid, ``current`` is replaced and the functions
    given to :meth:`on_change` are called with it. Callbacks of a node do not overlap, so this
    happens between two samples. Values given at start are validated in the same way. An unknown
    name is an error: a misspelt parameter would otherwise be ignored silently. Only in a section
    for several nodes, such as ``/**``, it is reported and ignored.
    """

    def __init__(self, node: Node, group: type[Group]) -> None:
        self._node = node
        self._group = group
        self._on_change: list[Callable[[Group], None]] = []
        self._names = {declaration.name: declaration for declaration in declared(group)}
        given = self._with_empty_lists()
        node._parameter_overrides = {name: self._with_type(given[name]) for name in given}
        self._warn_about_names()
        for declaration in declared(group):
            self._declare(declaration)
        self.current: Group = build(group, self._values())
        self._next = self.current
        node.add_pre_set_parameters_callback(self._with_types)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._keep)

    def on_change(self, apply: Callable[[Group], None]) -> None:
        """Call ``apply`` with the new parameters after every change."""
        self._on_change.append(apply)

    def _with_types(self, parameters: list[Parameter]) -> list[Parameter]:
        return [self._with_type(parameter) for parameter in parameters]

    def _with_type(self, parameter: Parameter) -> Parameter:
        """Convert a word that YAML has read as a boolean, an empty list, and a list of integers."""
        declaration = self._names.get(parameter.name)
        if declaration is None:
            return parameter
        if declaration.kind is list:
            return _with_list(parameter, declaration)
        value = declaration.word_from_bool(parameter.value)
        return parameter if value is parameter.value else Parameter(parameter.name, value=value)

    def _with_empty_lists(self) -> dict[str, Parameter]:
        """The start values; an empty list in a parameter file arrives as no value at all."""
        given = dict(self._node._parameter_overrides)
        for name, declaration in self._names.items():
            if declaration.kind is list and name in given and given[name].value is None:
                given[name] = Parameter(name, Parameter.Type.DOUBLE_ARRAY, [])
        return given

    def _warn_about_names(self) -> None:
        full_name = self._node.get_fully_qualified_name()
        given = self._node._parameter_overrides
        for warning in check_names(full_name, self._names, given, read_sections(ros_arguments())):
            self._node.get_logger().warning(warning)

    def _declare(self, declaration: Declared) -> None:
        try:
            self._node.declare_parameter(
                declaration.name, declaration.default, _descriptor(declaration)
            )
        except InvalidParameterTypeException as error:
            raise ParameterError(str(error)) from None

    def _values(self) -> dict[str, Any]:
        return {name: self._node.get_parameter(name).value for name in self._names}

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        if not all(parameter.name for parameter in parameters):
            return SetParametersResult(successful=False, reason="a parameter has no name")
        mine = {p.name: p.value for p in parameters if p.name in self._names}
        if mine:
            try:
                self._next = build(self._group, self._values() | mine)
            except ParameterError as error:
                return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _keep(self, parameters: list[Parameter]) -> None:
        if any(parameter.name in self._names for parameter in parameters):
            self.current = self._next
            for apply in self._on_change:
                apply(self.current)


def _with_list(parameter: Parameter, declaration: Declared) -> Parameter:
    """An empty list, whose type ROS tools do not know, means the default."""
    value = parameter.value
    if parameter.type_ in _LISTS and len(value) == 0:
        return Parameter(parameter.name, value=list(declaration.default))
    if parameter.type_ == Parameter.Type.INTEGER_ARRAY:
        return Parameter(parameter.name, value=[float(element) for element in value])
    return parameter


def _descriptor(declaration: Declared) -> ParameterDescriptor:
    """Type, meaning and allowed values; the range itself where ROS can hold it."""
    about = declaration.about
    has_range = _has_range(declaration)
    unit = f" [{about.unit}]" if about.unit else ""
    descriptor = ParameterDescriptor(
        name=declaration.name,
        type=_TYPES[declaration.kind].value,
        description=f"{about.meaning}{unit}",
        additional_constraints="" if has_range or about.allowed == "any" else about.allowed,
        read_only=about.read_only,
    )
    if has_range:
        if declaration.kind is float:
            descriptor.floating_point_range = [
                FloatingPointRange(from_value=float(about.low), to_value=float(about.high))
            ]
        elif declaration.kind is int:
            descriptor.integer_range = [
                IntegerRange(from_value=int(about.low), to_value=int(about.high), step=1)
            ]
    return descriptor


def _has_range(declaration: Declared) -> bool:
    """Whether ROS can hold the range: it knows no open ends."""
    bounded = math.isfinite(declaration.about.low) and math.isfinite(declaration.about.high)
    return bounded and declaration.kind in (float, int)
