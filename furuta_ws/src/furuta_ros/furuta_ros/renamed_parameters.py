"""Translates earlier parameter names and values to the current ones, with a warning.

The declaration of a renamed parameter lists its earlier names
(:class:`furuta_model.parameters.EarlierName`). Parameter files, the command line and the nodes all
use the functions here, so an earlier name works everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

from furuta_model.parameters import Declared, EarlierName, declared


class Renamed(NamedTuple):
    """A parameter and the full form of one of its earlier names."""

    name: str
    parameter: Declared
    earlier: EarlierName

    def current_value(self, value: Any) -> Any:
        """The current value for a value given under the earlier name."""
        current = self.earlier.current_value(value)
        return float(current) if self.parameter.kind is float and type(current) is int else current

    def warning(self, value: Any) -> str:
        """The warning for a ``value`` given under the earlier name."""
        current = self.current_value(value)
        if self.earlier.values:
            return f"use {self.parameter.name}={current} instead of {self.name}={value}"
        return f"parameter {self.name} is now called {self.parameter.name}"


@cache
def renamed(group: type[NamedTuple]) -> dict[str, Renamed]:
    """The renamed parameters of a group by their earlier full names."""
    found = {}
    for each in declared(group):
        prefix = each.name[: each.name.rfind(".") + 1]
        for earlier in each.about.earlier_names:
            name = prefix + earlier.name
            found[name] = Renamed(name, each, earlier)
    return found


def with_current_names(
    group: type[NamedTuple], given: Mapping[str, Any]
) -> tuple[dict[str, Any], list[str]]:
    """Return values by current names, and a warning for each earlier name among them.

    A value given under the current name takes precedence over one under an earlier name.
    """
    known = renamed(group)
    values = {name: value for name, value in given.items() if name not in known}
    warnings = []
    for name, value in given.items():
        if name in known:
            values.setdefault(known[name].parameter.name, known[name].current_value(value))
            warnings.append(known[name].warning(value))
    return values, warnings
