"""Reads text files that a user or another file names, and YAML, within bounds.

YAML is that of parameter files, rig files and values of options. An alias is refused, as ROS
refuses it in parameter files.
"""

from pathlib import Path
from typing import Any

import yaml

from furuta_model.parameters import ParameterError, shortened

# Largest file [bytes], and deepest nesting [levels], which the parser in C does not check itself.
# The parameter file of all nodes has 3 kB and 3 levels.
LARGEST_FILE = 2**21
UTF_16 = b"\xff\xfe", b"\xfe\xff"  # how such a file begins
DEEPEST_NESTING = 32

# The parser in C is 20 times as fast, and not in every build of PyYAML.
_SAFE_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class _Loader(_SAFE_LOADER):  # type: ignore[misc]
    """Rejects a name that is given twice: YAML's own takes the last value."""

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:
        given = set()
        for key, _ in node.value if isinstance(node, yaml.MappingNode) else ():
            if isinstance(key, yaml.ScalarNode) and (key.tag, key.value) in given:
                raise _error(f"{shortened(key.value)[1:-1]} is given twice", key)
            given.add((key.tag, str(key.value)))
        return super().construct_mapping(node, deep)


def read_text(file: Path, what: str) -> str:
    """The text of a file of at most :data:`LARGEST_FILE`; ``what`` names it in the error."""
    try:
        with file.open("rb") as stream:
            data = stream.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ParameterError(f"cannot read {what} {file}: {reason}") from None
    if len(data) > LARGEST_FILE:
        raise ParameterError(
            f"cannot read {what} {file}: larger than {LARGEST_FILE} bytes, the most allowed"
        )
    try:
        # As PowerShell redirects, or in UTF-8.
        return data.decode("utf-16" if data.startswith(UTF_16) else "utf-8")
    except UnicodeDecodeError:
        raise ParameterError(f"cannot read {what} {file}: not a text file") from None


def read_yaml(file: Path, what: str) -> Any:
    """The content of a YAML file; ``what`` names it in the error, such as ``rig file``.

    Raises:
        ParameterError: The file cannot be read, is not YAML, or exceeds the bounds.
    """
    return parse_yaml(read_text(file, what), f"{what} {file}")


def parse_yaml(text: str, what: str) -> Any:
    """The content of a YAML text; ``what`` names it in the error."""
    try:
        _check_nesting(text)
        return yaml.load(text, _Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" in line {mark.line + 1}" if mark else ""
        problem = getattr(error, "problem", None) or "malformed"
        raise ParameterError(f"{what} is not YAML: {problem}{where}") from None
    except (ValueError, LookupError, ArithmeticError, AttributeError) as error:
        # A value that its tag does not allow, such as a date that does not exist.
        raise ParameterError(f"{what} is not YAML: {error}") from None


def _check_nesting(text: str) -> None:
    """Reject aliases, and a text that nests too deep."""
    depth = 0
    for event in yaml.parse(text, _Loader):
        if isinstance(event, yaml.AliasEvent):
            raise _error(f"*{event.anchor} is an alias, write its value", event)
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > DEEPEST_NESTING:
            raise _error(f"nested deeper than {DEEPEST_NESTING} levels", event)


def _error(problem: str, at: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=at.start_mark)
