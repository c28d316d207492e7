"""Checks the names of the parameters that a node is started with.

ROS ignores a parameter that a node does not have, and a section of a parameter file that is for
another node. A misspelt name or a missing namespace would leave the node at its defaults.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from furuta_model.parameters import ParameterError, shortened
from furuta_ros.parameter_sections import Section
from furuta_ros.ros_parameters import is_of_ros


def check_names(
    node: str, known: Collection[str], given: Iterable[str], sections: Sequence[Section]
) -> list[str]:
    """Return warnings about the ``given`` parameters of the node of that full name.

    ``sections`` are those of the parameter files. A section for several nodes may have parameters
    that this one does not have; they are ignored, with a warning.

    Raises:
        ParameterError: A name is unknown, or a section lacks the namespace of the node.
    """
    applied = [each for each in sections if each.matches(node)]
    own = {name for each in applied if not each.for_several for name in each.names}
    shared = {name: each for each in applied if each.for_several for name in each.names}
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
    for file in dict.fromkeys(each.file for each in sections):
        of_file = [each for each in sections if each.file == file]
        matching = [each for each in of_file if each.matches(node)]
        if all(each.for_several for each in matching):
            _refuse_missing_namespace(of_file, node)
        if not matching:
            keys = _listed([each.key for each in of_file])
            warnings.append(f"{file} has no section for {node}, only for {keys}")
    return warnings


def _refuse_missing_namespace(sections: Sequence[Section], node: str) -> None:
    name = _last_part(node)
    for each in sections:
        if each.key.lstrip("/") == name:
            raise ParameterError(
                f"{each.file}: the section {each.key} is for /{name}, but this node is {node}; "
                f"call the section {node} or /**/{name}"
            )


def _last_part(name: str) -> str:
    return name.rpartition("/")[2]


def _listed(names: Sequence[str]) -> str:
    shown = [shortened(each)[1:-1] for each in names[:10]]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")
