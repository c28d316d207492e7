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
    return [section for file in files for section in _file_sections(file)]


def _file_sections(file: str) -> Iterator[Section]:
    content = read_yaml(Path(file), "parameter file")
    if isinstance(content, Mapping):
        for key, section in content.items():
            yield from _sections(file, str(key), section)


def _sections(file: str, key: str, section: Any) -> Iterator[Section]:
    """The section of a key, or those of the keys inside it: each level is a namespace."""
    if not isinstance(section, Mapping):
        return
    for name, inner in section.items():
        if name == PARAMETERS:
            given = by_full_name(inner) if isinstance(inner, Mapping) else ()
            yield Section(file, key, frozenset(parameter for parameter, _ in given))
        else:
            yield from _sections(file, f"{key}/{name}", inner)


def check_names(
    node: str, known: Collection[str], given: Iterable[str], sections: Sequence[Section]
) -> list[str]:
    """Return warnings about the ``given`` parameters of the node of that full name.

    ``sections`` are those of the parameter files. A section for several nodes may have parameters
    that this one does not have; they are ignored, with a warning.

    Raises:
        ParameterError: A name is unknown, or a section lacks the namespace of the node.
    """
    applied = [section for section in sections if section.matches(node)]
    own = {name for section in applied if not section.for_several for name in section.names}
    shared = {name: section for section in applied if section.for_several for name in section.names}
    unknown = [name for name in given if name not in known and not is_of_ros(name)]
    refused = sorted(name for name in unknown if name in own or name not in shared)
    if refused:
        raise ParameterError(
            f"{_last_part(node)} has no parameter {_listed(refused)}; it has "
            f"{', '.join(sorted(known))}"
        )
    return [*_missing_sections(sections, node), *_ignored(node, unknown, shared)]


def _ignored(node: str, unknown: Iterable[str], shared: dict[str, Section]) -> list[str]:
    """A warning for each section for several nodes with parameters that this one does not have."""
    by_section: dict[tuple[str, str], list[str]] = {}
    for name in sorted(unknown):
        by_section.setdefault(shared[name][:2], []).append(name)
    return [
        f"{_last_part(node)} has no parameter {_listed(names)}; ignored, because the section {key} "
        f"of {file} is for several nodes"
        for (file, key), names in by_section.items()
    ]


def _missing_sections(sections: Sequence[Section], node: str) -> list[str]:
    """A warning for each file without a section for the node."""
    warnings = []
    for file in dict.fromkeys(section.file for section in sections):
        of_file = [section for section in sections if section.file == file]
        matching = [section for section in of_file if section.matches(node)]
        if all(section.for_several for section in matching):
            _refuse_missing_namespace(of_file, node)
        if not matching:
            keys = _listed([section.key for section in of_file])
            warnings.append(f"{file} has no section for {node}, only for {keys}")
    return warnings


def _refuse_missing_namespace(sections: Sequence[Section], node: str) -> None:
    name = _last_part(node)
    for section in sections:
        if section.key.lstrip("/") == name:
            raise ParameterError(
                f"{section.file}: the section {section.key} is for /{name}, but this node is "
                f"{node}; call the section {node} or /**/{name}"
            )


def _last_part(name: str) -> str:
    return name.rpartition("/")[2]


def _listed(names: Sequence[str]) -> str:
    shown = [shortened(name)[1:-1] for name in names[:MOST_LISTED]]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")
