"""Says that functions are being compiled, which takes long where none is in the cache yet."""

import sys
from multiprocessing import parent_process
from threading import Semaphore
from time import monotonic
from typing import Any

from numba.core import event

NOTICE = "furuta: compiling; the first run takes up to a minute, later ones start at once"
# Time of compilation without a notice [s]: a few functions may be new after a change.
UNNOTICED = 2.0


# The right to print the notice, once. A worker has none of its own: its parent compiles too, or
# shares the right of all workers.
_right: Any = Semaphore(1 if parent_process() is None else 0)


def share_right(right: Any) -> None:
    """Print the notice by a semaphore that other processes have too."""
    global _right  # noqa: PLW0603 - the listener is one for the process
    _right = right


class _Notice(event.Listener):
    """Prints the notice when this process has compiled our functions for a while."""

    def __init__(self) -> None:
        self._begun: list[float] = []  # a function is compiled while the one that calls it is
        self._total = 0.0

    def on_start(self, event: Any) -> None:
        if not hasattr(event.data["dispatcher"], "furuta_digest"):
            return
        self._begun.append(monotonic())
        if self._total + monotonic() - self._begun[0] > UNNOTICED and _right.acquire(False):
            print(NOTICE, file=sys.stderr, flush=True)

    def on_end(self, event: Any) -> None:
        if not hasattr(event.data["dispatcher"], "furuta_digest"):
            return
        begun = self._begun.pop()
        if not self._begun:
            self._total += monotonic() - begun


def announce_compilation() -> None:
    """Print one line on standard error if this process compiles for long."""
    event.register("numba:compile", _Notice())
