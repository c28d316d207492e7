"""Prints results as JSON or for people, and makes text from files fit for the terminal."""

import json
import math
from collections.abc import Iterator
from typing import Any

# Most characters of a line; a name in a damaged or hostile file may have millions.
LONGEST_LINE = 2000
# Names whose values are lists of complex numbers, as real and imaginary part.
COMPLEX = ("poles", "zeros", "multipliers")


def printable(text: str) -> str:
    """The text as one line, not too long, with escapes for what a terminal would not print."""
    return escaped(text[:LONGEST_LINE] + (" ..." if len(text) > LONGEST_LINE else ""))


def escaped(text: str) -> str:
    """The text with escapes for what a terminal would not print, such as its own commands."""
    return "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)


def rounded(value: Any) -> str:
    """A value for a table: a number with six digits, which is more than is known."""
    if isinstance(value, (list, tuple)):
        return ", ".join(map(rounded, value)) or "none"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def show(result: dict[str, Any], as_json: bool) -> None:
    """Print a result: as one JSON object, or a line per value for people."""
    if as_json:
        print_json(result)
    else:
        print("\n".join(map(escaped, _lines(result))))


def _lines(result: dict[str, Any], indent: str = "") -> Iterator[str]:
    for name, value in result.items():
        title = f"{indent}{name:<{max(0, 24 - len(indent))}}"
        if isinstance(value, dict):
            yield title.rstrip()
            yield from _lines(value, indent + "  ")
        elif name.endswith(COMPLEX):
            yield f"{title} " + (", ".join(f"{re:.4g}{im:+.4g}j" for re, im in value) or "none")
        elif isinstance(value, list) and any(isinstance(item, (dict, list)) for item in value):
            yield title.rstrip()
            for item in value:
                row = item.items() if isinstance(item, dict) else [("", item)]
                yield indent + "  " + ", ".join(f"{k} {rounded(v)}".strip() for k, v in row)
        else:
            yield f"{title} {rounded(value)}"


def print_json(result: dict[str, Any]) -> None:
    """Print one JSON object on standard output; NaN becomes null."""
    print(json.dumps(finite(result)))


def finite(value: Any) -> Any:
    """The value with null instead of NaN and infinity, which JSON does not have."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return value
