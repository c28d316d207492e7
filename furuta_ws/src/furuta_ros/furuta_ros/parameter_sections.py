"""Checks the names of the parameters that a node is started with.

ROS ignores a parameter that a node does not have, and a section of a parameter file that is for
another node. A misspelt name or a missing namespace would leave the node at its defaults.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from furuta_model.parameters import ParameterError, shortened
from furuta_ros.ros_parameters import by_full_name, is_of_ros
from furuta_ros.yaml_files import read_yaml

PARAMETERS = "ros__parameters"
# Most names that a message lists.
MOST_LISTED = 10


class Section(NamedTuple):
    """A section of a parameter file: its key as it is written, and the names of its parameters."""

    file: str
    key: str
    names: frozenset[str]

    @property
    def for_several(self) -> bool:
        """Whether the section is for several nodes, such as ``/**``."""
        return "*" in self.key

    def matches(self, node: str) -> bool:
        """Whether ROS applies the section to the node of that full name."""
        pattern = re.escape("/" + self.key.lstrip("/"))
        pattern = pattern.replace(r"/\*\*", r"(/\w+)*").replace(r"\*", r"\w+")
        return re.fullmatch(pattern, node) is not None


def read_sections(arguments: Sequence[str]) -> list[Section]:
    """The sections of all parameter files among the arguments of a process.

    ROS has read the files before, so they are valid.
    """
    files = [value for flag, value in pairwise(arguments) if flag == "--params-file"]
    return [
        Section(file, key, names)
        for file in files
        for key, names in _sections(read_yaml(Path(file), "parameter file"))
    ]


def _sections(content: Any, key: str = "") -> Iterator[tuple[str, frozenset[str]]]:
    """Keys and names of the sections in a file: each level above the parameters is a namespace."""
    for name, inner in content.items() if isinstance(content, Mapping) else ():
        if name == PARAMETERS:
            given = by_full_name(inner) if isinstance(inner, Mapping) else ()
            yield key, frozenset(parameter for parameter, _ in given)
        else:
            yield from _sections(inner, f"{key}/{name}" if key else str(name))


def check_names(
    node: str, known: Collection[str], given: Iterable[str], sections: Sequence[Section]
) -> list[str]:
    """Return warnings about the ``given`` parameters of the node of that full name.

    ``sections`` are those of the parameter files. A section for several nodes may have parameters
    that this one does not have; they are ignored, with a warning.

    Raises:
        ParameterError: A name is unknown, or a section lacks the namespace of the node.
    """
    name = node.rpartition("/")[2]
    applied = [section for section in sections if section.matches(node)]
    own = {n for section in applied if not section.for_several for n in section.names}
    shared = {n for section in applied if section.for_several for n in section.names}
    unknown = [n for n in given if n not in known and not is_of_ros(n)]
    refused = sorted(n for n in unknown if n in own or n not in shared)
    if refused:
        raise ParameterError(
            f"{name} has no parameter {_listed(refused)}; it has {', '.join(sorted(known))}"
        )
    return _missing_sections(sections, node, name) + [
        f"{name} has no parameter {_listed(ignored)}; ignored, because the section {section.key} "
        f"of {section.file} is for several nodes"
        for section in applied
        if (ignored := sorted(section.names.intersection(unknown)))
    ]


def _missing_sections(sections: Sequence[Section], node: str, name: str) -> list[str]:
    """A warning for each file without a section for the node."""
    warnings = []
    for file in dict.fromkeys(section.file for section in sections):
        of_file = [section for section in sections if section.file == file]
        matching = [section for section in of_file if section.matches(node)]
        keys = [section.key for section in of_file]
        without_namespace = [key for key in keys if key.lstrip("/") == name]
        if without_namespace and all(section.for_several for section in matching):
            raise ParameterError(
                f"{file}: the section {without_namespace[0]} is for /{name}, but this node is "
                f"{node}; call the section {node} or /**/{name}"
            )
        if not matching:
            warnings.append(f"{file} has no section for {node}, only for {_listed(keys)}")
    return warnings


def _listed(names: Sequence[str]) -> str:
    shown = [shortened(name)[1:-1] for name in names[:MOST_LISTED]]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")
