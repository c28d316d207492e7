"""Finding parameters of the graph by name."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from typing import Any, NamedTuple

from furuta_model.parameters import Declared, ParameterError, declared
from furuta_sim.settings.nodes import NODES

EVERY_NODE = "/**"


class Match(NamedTuple):
    """A parameter of a node."""

    node: str
    parameter: Declared

    def parsed(self, value: Any) -> Any:
        """The value as the parameter has it."""
        return self.parameter.parsed(value)


def find_parameters(name: str) -> list[Match]:
    """Parameters that a name on the command line means.

    ``node.parameter`` means one. Any other name means every parameter with that full name or that
    last part: ``alpha0`` is the plant's true one and the observer's, ``alpha`` the true model's
    and the controller's nominal one.
    """
    node, _, rest = name.partition(".")
    if node in NODES:
        found = [match for full, match in _names(node) if full == rest]
    else:
        every = (named for node in NODES for named in _names(node))
        found = [match for full, match in every if name in (full, _last_part(full))]
    if not found:
        raise ParameterError(f"no parameter {name}{_suggestion(name)}")
    return found


def parameters_named(name: str) -> list[tuple[str, Declared]]:
    """Node and declaration of the parameters that a name on the command line means."""
    return [(match.node, match.parameter) for match in find_parameters(name)]


def find_in_node(node: str, name: str) -> list[Match]:
    """The parameter of a node by its full name; for ``/**`` that of every node that has it."""
    nodes = NODES if node == EVERY_NODE else [node]
    found = [match for each in nodes for full, match in _names(each) if full == name]
    if not found:
        raise ParameterError(f"{node} has no parameter {name}{_suggestion(name)}")
    return found


def _names(node: str) -> Iterator[tuple[str, Match]]:
    """A node's parameters by full name."""
    for parameter in declared(NODES[node].parameters):
        yield parameter.name, Match(node, parameter)


def _last_part(name: str) -> str:
    return name.rpartition(".")[2]


def _suggestion(name: str) -> str:
    every = {each.name for node in NODES.values() for each in declared(node.parameters)}
    known = every | {_last_part(each) for each in every}
    near = difflib.get_close_matches(_last_part(name), sorted(known), n=3)
    return f"; did you mean {', '.join(near)}?" if near else ""
