"""How a long computation shows how far it is, without knowing to whom."""

from collections.abc import Callable, Iterable
from typing import Any

# Yields the items that it is given, of the number given, and may show how far it is.
Progress = Callable[[Iterable[Any], int], Iterable[Any]]


def unseen(items: Iterable[Any], number: int) -> Iterable[Any]:
    """The items; nothing is shown."""
    return items
