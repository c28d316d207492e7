"""Prints results as JSON or for people, tables and progress, with text fit for the terminal."""

from __future__ import annotations

import codecs
import json
import sys
import unicodedata
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from furuta.results.plain import plain
from furuta.results.text import escaped, values_text

if TYPE_CHECKING:
    from furuta.results.result import Result
    from furuta_model.progress import Progress

Item = TypeVar("Item")

# Most characters of a line; a name in a damaged or hostile file may have millions.
LONGEST_LINE = 2000
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


def show(
    result: Any,
    as_json: bool,
    figure: Path | None = None,
    drawn: Result | None = None,
    **more: Any,
) -> None:
    """Print a result, or values by name, as one JSON object or as text; draw a ``figure``.

    The figure is that of ``drawn``, by default of the result. What cannot be drawn is printed all
    the same. ``more`` are values that only the JSON object has.
    """
    if not as_json:
        print_text(values_text(result) if type(result) is dict else result.report())
    try:
        if figure is not None:
            draw(drawn or result, figure)
            more["figure"] = str(figure)
            if not as_json:
                print_text(values_text({"figure": str(figure)}))
    finally:
        if as_json:
            print_json((result if type(result) is dict else result.to_dict()) | more)


def draw(result: Result, path: Path) -> None:
    """Write the figure of a result."""
    from furuta.figures.figure import save_figure

    save_figure(result.plot, path)


def print_text(text: str) -> None:
    """Print lines with escapes for what a terminal would not print."""
    print("\n".join(map(escaped, text.splitlines())))


def print_json(result: dict[str, Any]) -> None:
    """Print one JSON object on standard output; NaN becomes null."""
    print(json.dumps(plain(result)))


def bar(title: str, quiet: bool = False) -> Progress:
    """What shows on the terminal how far a computation is."""
    return lambda items, number: with_progress(title, items, number, quiet)


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
def with_status(
    text: str, quiet: bool = False, lines: bool = False
) -> Iterator[Callable[[str], None]]:
    """Show a text with a moving sign on the terminal during the ``with`` block.

    The block gets a function that changes the text; without a terminal it prints ``lines`` if they
    are wanted. It must not print a result: that is for standard output.
    """
    is_terminal = sys.stderr.isatty()
    if quiet or not (is_terminal or lines):
        yield lambda text: None
        return
    from rich.console import Console
    from rich.markup import escape

    console = Console(stderr=True)
    with console.status(escape(text)) as status:
        shown = status.update if is_terminal else console.print
        yield lambda text: shown(escape(escaped(text)))
