"""Makes text from files, and numbers, fit for the terminal."""

from __future__ import annotations

from typing import Any

# Most characters of a line; a name in a damaged or hostile file may have millions.
LONGEST_LINE = 2000


def printable(text: str) -> str:
    """The text as one line, with escapes for what a terminal would not print."""
    shown = text[:LONGEST_LINE] + (" ..." if len(text) > LONGEST_LINE else "")
    return "".join(each if each.isprintable() else ascii(each)[1:-1] for each in shown)


def rounded(value: Any) -> str:
    """A value for a table: a number with six digits, which is more than is known."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
