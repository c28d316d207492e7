"""Finding parameters of the graph by name, today's or earlier ones."""

from __future__ import annotations

import difflib
import logging
from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

from furuta_model.parameters import Declared, ParameterError, declared
from furuta_ros.renamed_parameters import Renamed, renamed
from furuta_sim.settings.nodes import NODES

EVERY_NODE = "/**"
_LOG = logging.getLogger(__name__)


class Match(NamedTuple):
    """A parameter of a node; ``renamed`` if it was found by an earlier name."""

    node: str
    parameter: Declared
    renamed: Renamed | None = None

    def parsed(self, value: Any) -> Any:
        """The value as the parameter has it; warns about an earlier name."""
        if self.renamed is not None:
            warn_once(f"{self.node}: {self.renamed.warning(value)}")
            value = self.renamed.current_value(value)
        return self.parameter.parsed(value)


@cache
def warn_once(message: str) -> None:
    """Log a warning; the same one only once, since studies read the same settings many times."""
    _LOG.warning(message)


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
    """Full names of a node's parameters, earlier ones included."""
    group = NODES[node].parameters
    for each in declared(group):
        yield each.name, Match(node, each)
    for name, found in renamed(group).items():
        yield name, Match(node, found.parameter, found)


def _last_part(name: str) -> str:
    return name.rpartition(".")[2]


def _suggestion(name: str) -> str:
    every = {each.name for node in NODES.values() for each in declared(node.parameters)}
    known = every | {_last_part(each) for each in every}
    near = difflib.get_close_matches(_last_part(name), sorted(known), n=3)
    return f"; did you mean {', '.join(near)}?" if near else ""
