"""Reads ROS parameter files into sections, and checks names of parameters against them.

ROS ignores a parameter that a node does not have, and a section of a parameter file that is for
another node. A misspelt name or a missing namespace would leave the node at its defaults.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from furuta_model.parameters import ParameterError, shortened
from furuta_ros.yaml_files import read_yaml

PARAMETERS = "ros__parameters"
# Parameters that every node has; this project does not declare them.
OF_ROS = ("use_sim_time", "start_type_description_service")
# Most names that a message lists.
MOST_LISTED = 10


class Section(NamedTuple):
    """A section of a parameter file: its key as it is written, and its parameters by full name."""

    file: str
    key: str
    parameters: dict[str, Any]

    @property
    def for_several(self) -> bool:
        """Whether the section is for several nodes, such as ``/**``."""
        return "*" in self.key

    @property
    def namespace(self) -> str:
        """The namespace of its node, such as ``/left``; empty without one."""
        above = self.key.strip("/").rpartition("/")[0]
        return f"/{above}" if above else ""

    def is_in(self, namespace: str) -> bool:
        """Whether ROS applies the section to a node in the namespace."""
        return self.matches(f"{namespace}/{self.key.rpartition('/')[2].replace('*', '_')}")

    def matches(self, node: str) -> bool:
        """Whether ROS applies the section to the node of that full name."""
        pattern = re.escape("/" + self.key.lstrip("/"))
        pattern = pattern.replace(r"/\*\*", r"(/\w+)*").replace(r"\*", r"\w+")
        return re.fullmatch(pattern, node) is not None


def is_of_ros(name: str) -> bool:
    """Whether every ROS node has the parameter."""
    return name in OF_ROS or name.startswith("qos_overrides.")


def sections(content: Any, file: Path, key: str = "") -> Iterator[Section]:
    """The sections in a file's ``content``: each level above the parameters is a namespace.

    Raises:
        ParameterError: Something in the file is no section.
    """
    if not isinstance(content, Mapping) or not content:
        whose = f"{shortened(key)[1:-1]} has no" if key else "it must map node names to"
        raise ParameterError(f"{file}: {whose} {PARAMETERS}")
    for name, inner in content.items():
        if name != PARAMETERS:
            below = f"{key.rstrip('/')}/{str(name).lstrip('/')}" if key else str(name)
            yield from sections(inner, file, below)
        elif isinstance(inner, Mapping):
            yield Section(str(file), key, dict(_by_full_name(inner)))
        else:
            raise ParameterError(f"{file}: {PARAMETERS} of {key} has no names")


def _by_full_name(parameters: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Full names and values of the parameters in a section, whose names may nest."""
    for name, value in parameters.items():
        if isinstance(value, Mapping):
            yield from _by_full_name(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def read_sections(file: Path) -> list[Section]:
    """The sections of a parameter file; none if it is empty."""
    content = read_yaml(file, "parameter file")
    return list(sections(content, file)) if content else []


def sections_given(arguments: Sequence[str]) -> list[Section]:
    """The sections of all parameter files among the arguments of a process."""
    files = [value for flag, value in pairwise(arguments) if flag == "--params-file"]
    return [section for file in files for section in read_sections(Path(file))]


def check_names(
    node: str, known: Collection[str], given: Iterable[str], every: Sequence[Section]
) -> list[str]:
    """Return warnings about the ``given`` parameters of the node of that full name.

    ``every`` are the sections of the parameter files. A section for several nodes may have
    parameters that this one does not have; they are ignored, with a warning.

    Raises:
        ParameterError: A name is unknown, or a section lacks the namespace of the node.
    """
    name = node.rpartition("/")[2]
    applied = [section for section in every if section.matches(node)]
    own = {n for section in applied if not section.for_several for n in section.parameters}
    shared = {n for section in applied if section.for_several for n in section.parameters}
    unknown = [n for n in given if n not in known and not is_of_ros(n)]
    refused = sorted(n for n in unknown if n in own or n not in shared)
    if refused:
        raise ParameterError(
            f"{name} has no parameter {listed(refused)}; it has {', '.join(sorted(known))}"
        )
    return _missing_sections(every, node, name) + [
        f"{name} has no parameter {listed(ignored)}; ignored, because the section {section.key} "
        f"of {section.file} is for several nodes"
        for section in applied
        if (ignored := sorted(section.parameters.keys() & set(unknown)))
    ]


def _missing_sections(every: Sequence[Section], node: str, name: str) -> list[str]:
    """A warning for each file without a section for the node."""
    warnings = []
    for file in dict.fromkeys(section.file for section in every):
        of_file = [section for section in every if section.file == file]
        matching = [section for section in of_file if section.matches(node)]
        keys = [section.key for section in of_file]
        without_namespace = [key for key in keys if key.lstrip("/") == name]
        if without_namespace and all(section.for_several for section in matching):
            raise ParameterError(
                f"{file}: the section {without_namespace[0]} is for /{name}, but this node is "
                f"{node}; call the section {node} or /**/{name}"
            )
        if not matching:
            warnings.append(f"{file} has no section for {node}, only for {listed(keys)}")
    return warnings


def listed(names: Sequence[str]) -> str:
    """Names as a message shows them: each shortened, and only the first of many."""
    shown = [shortened(name)[1:-1] for name in names[:MOST_LISTED]]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")
