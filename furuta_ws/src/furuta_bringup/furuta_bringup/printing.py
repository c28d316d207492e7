"""Prints results as JSON or for people, tables and progress, with text fit for the terminal."""

import codecs
import json
import math
import sys
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from io import TextIOWrapper
from typing import Any, TypeVar

Item = TypeVar("Item")

# Most characters of a line; a name in a damaged or hostile file may have millions.
LONGEST_LINE = 2000
WIDEST = 10_000  # of a table [characters]
# Names whose values are lists of complex numbers, as real and imaginary part.
COMPLEX = ("poles", "zeros", "multipliers")
# How to spell signs in an encoding that lacks them; Greek letters have their names.
SPELLINGS = {"≤": "<=", "≥": ">=", "→": "->", "−": "-", "–": "-", "·": "*", "±": "+-", "°": "deg"}
SPELLINGS |= {"\N{COMBINING CIRCUMFLEX ACCENT}": "^", "\N{COMBINING DOT ABOVE}": "'", "μ": "u"}


def print_in_any_encoding() -> None:
    """Spell what the encoding of an output lacks: a file on Windows has no ω, but can say omega."""
    codecs.register_error("spelled", _spelled)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="spelled")


def _spelled(error: UnicodeError) -> tuple[str, int]:
    assert isinstance(error, UnicodeEncodeError)
    text = unicodedata.normalize("NFKD", error.object[error.start : error.end])
    return "".join(map(_spelling, text)), error.end


def _spelling(char: str) -> str:
    if char.isascii() or char in SPELLINGS:
        return SPELLINGS.get(char, char)
    if unicodedata.combining(char):
        return ""
    name = unicodedata.name(char, "").lower().split()
    if name[:1] == ["greek"]:
        return name[3] if char.islower() else name[3].capitalize()
    return ascii(char)[1:-1]


def print_file(text: str) -> None:
    """Print the content of a text file: in UTF-8, as files are read, unless on a terminal."""
    if isinstance(sys.stdout, TextIOWrapper) and not sys.stdout.isatty():
        sys.stdout.reconfigure(encoding="utf-8")
    print(text, end="")


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


def with_progress(
    title: str, items: Iterable[Item], size: int, quiet: bool = False
) -> Iterator[Item]:
    """The items, with a bar on the terminal that advances with each of them."""
    if quiet or not sys.stderr.isatty():
        yield from items
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(title, total=size)
        for item in items:
            yield item
            progress.advance(task)


@contextmanager
def with_status(text: str, quiet: bool = False) -> Iterator[Callable[[str], None]]:
    """Show a text with a moving sign on the terminal during the ``with`` block.

    The block gets a function that changes the text. It must not print a result: that is for
    standard output.
    """
    if quiet or not sys.stderr.isatty():
        yield lambda text: None
        return
    from rich.console import Console
    from rich.markup import escape

    with Console(stderr=True).status(escape(text)) as status:
        yield lambda text: status.update(escape(text))


def print_table(title: str, rows: Iterable[Mapping[str, Any]], headings: Mapping[str, str]) -> None:
    """Print the columns that ``headings`` names; the first one is text, NaN and None are dashes."""
    from rich.box import SIMPLE
    from rich.markup import escape
    from rich.table import Table

    table = Table(title=escape(title), box=SIMPLE, padding=(0, 0, 0, 1), pad_edge=False)
    for number, heading in enumerate(headings.values()):
        justify: Any = "right" if number else "left"
        table.add_column(escape(heading), justify=justify, no_wrap=not number)
    for row in rows:
        values = (finite(row[name]) for name in headings)
        texts = (f"{value:.3g}" if isinstance(value, float) else value for value in values)
        table.add_row(*("–" if text is None else escape(escaped(str(text))) for text in texts))
    console().print(table)


def console() -> Any:
    """Standard output; a pipe or a file is as wide as a table, so that no number is cut."""
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else WIDEST)
