"""Reads which sections the parameter files of a process have, and which parameters each sets."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from furuta_ros.ros_parameters import by_full_name
from furuta_ros.yaml_files import read_yaml

PARAMETERS = "ros__parameters"


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
    flags = pairwise(arguments)
    files = [value for flag, value in flags if flag == "--params-file"]
    return [each for file in files for each in _file_sections(file)]


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
            yield Section(file, key, frozenset(each for each, _ in given))
        else:
            yield from _sections(file, f"{key}/{name}", inner)
