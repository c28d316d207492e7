"""Reads YAML within bounds: parameter files, rig files, metadata of bags, values of options.

YAML lets a text of a few lines stand for more values than a computer can hold, because an alias
repeats a value that may contain aliases itself. Size, depth and number of values are therefore
checked before anything is built.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from furuta_model.parameters import ParameterError
from furuta_ros.regular_files import read_text

# Largest file [bytes], deepest nesting [levels], and most values, each counted as often as aliases
# repeat it. The parameter file of all nodes has 3 kB, 3 levels and 200 values.
LARGEST_FILE = 2**21
DEEPEST_NESTING = 32
MOST_VALUES = 200_000
# Longest number [characters]. Reading one takes a time that grows with the square of its length.
LONGEST_NUMBER = 1000

# The parser in C is 20 times as fast, and not in every build of PyYAML.
_SAFE_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class _UniqueNames:
    """Rejects a mapping that gives a name twice; YAML's own loader takes the last value."""

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:
        given = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode) and (key.tag, key.value) in given:
                problem = f"{key.value} is given twice"
                raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
            given.add((key.tag, key.value))
        return super().construct_mapping(node, deep)  # type: ignore[misc]


_LOADER: Any = type("Loader", (_UniqueNames, _SAFE_LOADER), {})


def read_yaml(file: Path, what: str) -> Any:
    """The content of a YAML file; ``what`` names it in the error, such as ``rig file``.

    Raises:
        ParameterError: The file cannot be read, is not YAML, or exceeds the bounds.
    """
    return parse_yaml(read_text(file, what, LARGEST_FILE), f"{what} {file}")


def parse_yaml(text: str, what: str) -> Any:
    """The content of a YAML text; ``what`` names it in the error."""
    try:
        _check_size(yaml.parse(text, _LOADER), what)
        return yaml.load(text, _LOADER)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" in line {mark.line + 1}" if mark else ""
        problem = getattr(error, "problem", None) or "malformed"
        raise ParameterError(f"{what} is not YAML: {problem}{where}") from None
    except ParameterError:
        raise
    except (ValueError, OverflowError) as error:  # a date or number that does not exist
        raise ParameterError(f"{what} is not YAML: {error}") from None


def _check_size(events: Iterator[Any], what: str) -> None:
    """Reject a text that nests too deep or stands for too many values."""
    values = 0
    sizes: dict[str | None, int] = {}  # values in each finished node, by its anchor
    unfinished: list[tuple[str | None, int]] = []  # anchor and number of values before
    for event in events:
        if isinstance(event, yaml.AliasEvent):
            _check_finished(event, unfinished, what)
            values += sizes.get(event.anchor, 0)
        elif isinstance(event, yaml.ScalarEvent):
            _check_number(event, what)
            values += 1
            sizes[event.anchor] = 1
        elif isinstance(event, yaml.CollectionStartEvent):
            unfinished.append((event.anchor, values))
            values += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, before = unfinished.pop()
            sizes[anchor] = values - before
        _check_bounds(event, len(unfinished), values, what)


def _check_finished(alias: Any, unfinished: list[tuple[str | None, int]], what: str) -> None:
    if any(anchor == alias.anchor for anchor, _ in unfinished):
        raise ParameterError(f"{what}: *{alias.anchor} {_place(alias)} contains itself")


def _check_number(event: Any, what: str) -> None:
    """Reject text that is too long for a number, if it would be read as one."""
    is_plain, _ = event.implicit
    starts_as_number = is_plain and event.value[:1] in set("+-.0123456789")
    may_be_number = event.tag is not None or starts_as_number
    if may_be_number and len(event.value) > LONGEST_NUMBER:
        raise ParameterError(
            f"{what}: a number of {len(event.value)} characters {_place(event)}, at most "
            f"{LONGEST_NUMBER} are allowed"
        )


def _check_bounds(event: Any, depth: int, values: int, what: str) -> None:
    if depth > DEEPEST_NESTING:
        raise ParameterError(f"{what}: nested deeper than {DEEPEST_NESTING} levels {_place(event)}")
    if values > MOST_VALUES:
        raise ParameterError(
            f"{what}: more than {MOST_VALUES} values, aliases written out, {_place(event)}"
        )


def _place(event: Any) -> str:
    return f"in line {event.start_mark.line + 1}"
