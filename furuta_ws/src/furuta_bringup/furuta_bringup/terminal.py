"""Progress bars and tables on the terminal."""

import sys
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeVar

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress
from rich.table import Table

from furuta_bringup.printing import escaped, finite

Item = TypeVar("Item")
WIDEST = 10_000  # of a table [characters]


def with_progress(
    title: str, items: Iterable[Item], size: int, completed: int = 0, quiet: bool = False
) -> Iterator[Item]:
    """The items, with a bar on the terminal that advances with each of them."""
    console = Console(stderr=True, quiet=quiet or not sys.stderr.isatty())
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task(title, total=size, completed=completed)
        for item in items:
            yield item
            progress.advance(task)


def print_table(title: str, rows: Iterable[Mapping[str, Any]], headings: Mapping[str, str]) -> None:
    """Print the columns that ``headings`` names; the first one is text, NaN and None are dashes."""
    table = Table(title=escape(title), box=SIMPLE, padding=(0, 0, 0, 1), pad_edge=False)
    for number, heading in enumerate(headings.values()):
        justify: Any = "right" if number else "left"
        table.add_column(escape(heading), justify=justify, no_wrap=not number)
    for row in rows:
        values = (finite(row[name]) for name in headings)
        texts = (f"{value:.3g}" if isinstance(value, float) else value for value in values)
        table.add_row(*("–" if text is None else escape(escaped(str(text))) for text in texts))
    console().print(table)


def console() -> Console:
    """Standard output; a pipe or a file is as wide as a table, so that no number is cut."""
    return Console(width=None if sys.stdout.isatty() else WIDEST)
