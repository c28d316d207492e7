"""ROS parameters of a node from a declared group of parameters (furuta_model.parameters).

Their services give way to the node's samples.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from time import monotonic
from typing import Generic, NamedTuple, TypeVar

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.exceptions import InvalidParameterTypeException, ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService

from furuta_model.accepted_parts import (
    OWN_PARTS,
    accept_parts,
    accepted_parts,
    is_accepted,
    parts_in,
)
from furuta_model.parameters import Declared, ParameterError, build, declared, shortened
from furuta_ros.parameter_files import check_names, listed, sections_given
from furuta_ros.process import ROS_ARGUMENTS
from furuta_ros.yaml_files import parse_yaml

Group = TypeVar("Group", bound=NamedTuple)

_TYPES = {
    float: Parameter.Type.DOUBLE,
    int: Parameter.Type.INTEGER,
    bool: Parameter.Type.BOOL,
    str: Parameter.Type.STRING,
    list: Parameter.Type.DOUBLE_ARRAY,
}
# Requests per second that a process fulfils in the long run, and at once.
RATE, BURST = 50.0, 20.0


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
        _accept_own_parts(node)
        given = node._parameter_overrides
        node._parameter_overrides = {name: self._with_type(given[name]) for name in given}
        self._warn_about_names()
        for declaration in declared(group):
            self._declare(declaration)
        self._values = {name: node.get_parameter(name).value for name in self._names}
        self.current: Group = build(group, self._values)
        self._next = self._values, self.current
        node.add_pre_set_parameters_callback(lambda given: [self._with_type(p) for p in given])
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._keep)

    def on_change(self, apply: Callable[[Group], None]) -> None:
        """Call ``apply`` with the new parameters after every change."""
        self._on_change.append(apply)

    def _with_type(self, parameter: Parameter) -> Parameter:
        """Convert a word that YAML has read as a boolean, an empty list, and a list of integers."""
        declaration = self._names.get(parameter.name)
        if declaration is None:
            return parameter
        kind, value = parameter.type_, parameter.value
        if declaration.kind is not list:
            value = declaration.word_from_bool(value)
        elif value is None or ("ARRAY" in kind.name and len(value) == 0):
            # The default: ROS tools do not know the type of an empty list, files give no value.
            value = list(declaration.default)
        elif kind == Parameter.Type.INTEGER_ARRAY:
            value = [float(element) for element in value]
        return parameter if value is parameter.value else Parameter(parameter.name, value=value)

    def _warn_about_names(self) -> None:
        full_name = self._node.get_fully_qualified_name()
        given = self._node._parameter_overrides
        for warning in check_names(full_name, self._names, given, sections_given(ROS_ARGUMENTS)):
            self._node.get_logger().warning(warning)

    def _declare(self, declaration: Declared) -> None:
        try:
            self._node.declare_parameter(
                declaration.name, declaration.default, _descriptor(declaration)
            )
        except InvalidParameterTypeException as error:
            given, about = self._node._parameter_overrides[declaration.name], declaration.about
            wanted = f"{declaration.name} must be {about.allowed}, given {shortened(given.value)}"
            raise ParameterError(wanted if about.choices else str(error)) from None

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        if not all(parameter.name for parameter in parameters):
            return SetParametersResult(successful=False, reason="a parameter has no name")
        mine = {p.name: p.value for p in parameters if p.name in self._names}
        if mine:
            try:
                values = self._values | mine
                self._next = values, build(self._group, values)
            except ParameterError as error:
                return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _keep(self, parameters: list[Parameter]) -> None:
        if any(parameter.name in self._names for parameter in parameters):
            self._values, self.current = self._next
            for apply in self._on_change:
                apply(self.current)


def _accept_own_parts(node: Node) -> None:
    """Accept the parts of one's own that the command line names, and show them as a parameter.

    A parameter file can come from anywhere: it may only repeat names that are accepted.
    """
    accept_parts(_named_parts(ROS_ARGUMENTS))
    given = node._parameter_overrides.pop(OWN_PARTS, None)
    refused = [name for name in parts_in(given.value if given else "") if not is_accepted(name)]
    if refused:
        raise ParameterError(
            f"{OWN_PARTS} names code, so a parameter file cannot add {shortened(refused[0])}; give "
            f"it where the process is started: --ros-args -p {OWN_PARTS}:=NAME"
        )
    meaning = "parts of one's own that this process accepts, separated by commas"
    descriptor = ParameterDescriptor(description=meaning, read_only=True)
    node.declare_parameter(OWN_PARTS, ",".join(accepted_parts()), descriptor)


def _named_parts(arguments: Sequence[str]) -> Iterator[str]:
    """The names in ``-p own_parts:=NAMES``, which a node's name may precede."""
    for flag, value in pairwise(arguments):
        name, _, text = value.partition(":=")
        if flag in ("-p", "--param") and name.rpartition(":")[2] == OWN_PARTS:
            yield from parts_in(parse_yaml(text, OWN_PARTS))


def _descriptor(declaration: Declared) -> ParameterDescriptor:
    """Type, meaning and allowed values; the range itself where ROS can hold it."""
    about, kind = declaration.about, declaration.kind
    # ROS knows no open ends.
    has_range = kind in (float, int) and math.isfinite(about.low) and math.isfinite(about.high)
    unit = f" [{about.unit}]" if about.unit else ""
    descriptor = ParameterDescriptor(
        name=declaration.name,
        type=_TYPES[kind].value,
        description=f"{about.meaning}{unit}",
        additional_constraints="" if has_range or about.allowed == "any" else about.allowed,
        read_only=about.read_only,
    )
    if has_range and kind is float:
        ends = {"from_value": float(about.low), "to_value": float(about.high)}
        descriptor.floating_point_range = [FloatingPointRange(**ends)]
    elif has_range:
        ends = {"from_value": int(about.low), "to_value": int(about.high)}
        descriptor.integer_range = [IntegerRange(**ends, step=1)]
    return descriptor


class Allowance:
    """Permits ``RATE`` requests per second, and ``BURST`` at once."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._left, self._at = BURST, clock()

    def take(self) -> bool:
        """Whether one more request is permitted now."""
        now = self._clock()
        self._left = min(BURST, self._left + RATE * (now - self._at))
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


# All nodes of a process share a thread with its samples.
_allowance = Allowance()


class FurutaParameterService(ParameterService):
    """Refuses requests beyond a rate, and changes that ROS cannot read, with a reason.

    Without ``limited`` it accepts any number, for a node that may be late. A read-only parameter
    may be set to the value that it has, so that all that was saved can be loaded.
    """

    def __init__(self, node: Node) -> None:
        super().__init__(node)
        self.limited = True

    def _set_parameters_callback(
        self, request: SetParameters.Request, response: SetParameters.Response
    ) -> SetParameters.Response:
        """Set all at once, or each by itself if that is refused."""
        messages = request.parameters
        result = (refusal := self._refusal()) or self._change(messages)
        # A request for more than all parameters could hold up the node for long.
        most = len(self._get_node()._parameters)
        if not result.successful and refusal is None and 1 < len(messages) <= most:
            response.results = [self._change([message]) for message in messages]
        else:
            response.results = [result] * len(messages)
        return response

    def _set_parameters_atomically_callback(
        self, request: SetParametersAtomically.Request, response: SetParametersAtomically.Response
    ) -> SetParametersAtomically.Response:
        response.result = self._refusal() or self._change(request.parameters)
        return response

    def _refusal(self) -> SetParametersResult | None:
        """The answer to a request beyond the rate; None if it is permitted."""
        if not self.limited or _allowance.take():
            return None
        return _refused(f"more than {RATE:g} requests to set parameters per second; try again")

    def _change(self, messages: Sequence[ParameterMessage]) -> SetParametersResult:
        """Set all of the parameters or none."""
        node = self._get_node()
        try:
            given = [Parameter.from_parameter_msg(message) for message in messages]
            # rclpy refuses these too, but does not name them.
            undeclared = [p.name for p in given if p.name and not node.has_parameter(p.name)]
            if undeclared:
                return _refused(f"undeclared parameter: {listed(undeclared)}")
            changes = [each for each in given if not _is_kept(node, each)]
            if given and not changes:
                return SetParametersResult(successful=True)
            return node.set_parameters_atomically(changes)
        except (ParameterException, ValueError) as error:
            return _refused(str(error))


def _is_kept(node: Node, given: Parameter) -> bool:
    """Whether a parameter is read-only and has this value."""
    if not node.has_parameter(given.name) or not node.describe_parameter(given.name).read_only:
        return False
    return bool(node.get_parameter(given.name).value == given.value)


def _refused(reason: str) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=reason)
