"""Progress of a study as a bar on the terminal."""

import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

from rich.console import Console
from rich.progress import Progress

Item = TypeVar("Item")


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
