"""Finding parameters of the graph by name."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from furuta.settings.nodes import NODES
from furuta_model.parameters import Declared, ParameterError, declared, suggestion

EVERY_NODE = "/**"


class Match(NamedTuple):
    """A parameter of a node."""

    node: str
    parameter: Declared


def parameters_named(name: str) -> list[Match]:
    """Parameters that a name on the command line means.

    ``node.parameter`` means one. Any other name means every parameter with that full name or that
    last part: ``alpha0`` is the plant's true one and the observer's, ``alpha`` the true model's
    and the controller's nominal one.
    """
    node, _, rest = name.partition(".")
    if node in NODES:
        matches = [match for match in _parameters(node) if match.parameter.name == rest]
    else:
        matches = [
            match
            for node in NODES
            for match in _parameters(node)
            if name in (match.parameter.name, _last_part(match.parameter.name))
        ]
    if not matches:
        raise ParameterError(f"no parameter {name}{_suggestion(name)}")
    return matches


def declared_unit(name: str) -> str:
    """The unit of the parameters with a name; "" if there is none or they differ."""
    try:
        units = {match.parameter.about.unit for match in parameters_named(name)}
    except ParameterError:
        return ""
    return units.pop() if len(units) == 1 else ""


def parameters_in(node: str, name: str) -> list[Match]:
    """The parameter of a node by its full name; for ``/**`` that of every node that has it."""
    nodes = NODES if node == EVERY_NODE else [node]
    parameters = (match for name_of_node in nodes for match in _parameters(name_of_node))
    matches = [match for match in parameters if match.parameter.name == name]
    if not matches:
        raise ParameterError(f"{node} has no parameter {name}{_suggestion(name)}")
    return matches


def _parameters(node: str) -> list[Match]:
    return [Match(node, parameter) for parameter in declared(NODES[node].parameters)]


def _last_part(name: str) -> str:
    return name.rpartition(".")[2]


def _suggestion(name: str) -> str:
    full_names = {match.parameter.name for node in NODES for match in _parameters(node)}
    known = full_names | {_last_part(full_name) for full_name in full_names}
    return suggestion(name, sorted(known))


def by_node(values: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Values by node and name from values by full name."""
    nodes: dict[str, dict[str, Any]] = {}
    for full_name, value in values.items():
        node, _, name = full_name.partition(".")
        nodes.setdefault(node, {})[name] = value
    return nodes
