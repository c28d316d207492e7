"""A thread that makes slow calls in order; of several waiting with one key only the newest runs."""

from __future__ import annotations

import contextlib
import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import TypeAlias

Work: TypeAlias = Callable[[], None]
Failed: TypeAlias = Callable[[str], None]


class Jobs:
    """Does work in a thread of its own."""

    def __init__(self) -> None:
        self._waiting: OrderedDict[Hashable, tuple[Work, Failed]] = OrderedDict()
        self._changed = threading.Condition()
        self._running: Hashable = None
        self._ended = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def submit(self, key: Hashable, work: Work, failed: Failed = lambda reason: None) -> None:
        """Do ``work`` after what waits; it replaces what waits with the same key.

        If it raises an exception, ``failed`` is called with the reason.
        """
        with self._changed:
            self._waiting[key] = work, failed
            self._changed.notify_all()

    def pending(self, key: Hashable) -> bool:
        """Whether work with this key waits or runs."""
        with self._changed:
            return key in self._waiting or key == self._running

    def finish(self, timeout: float) -> None:
        """Wait up to ``timeout`` [s] until nothing waits or runs."""
        with self._changed:
            self._changed.wait_for(lambda: not self._waiting and self._running is None, timeout)

    def close(self, timeout: float) -> None:
        """Forget what waits, and wait up to ``timeout`` [s] for what runs."""
        with self._changed:
            self._waiting.clear()
            self._ended = True
            self._changed.notify_all()
        self._thread.join(timeout)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._running = None
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._waiting or self._ended)
                if self._ended:
                    return
                self._running, (work, failed) = self._waiting.popitem(last=False)
            _do(work, failed)


def _do(work: Work, failed: Failed) -> None:
    """Do work; the thread goes on, whatever happens."""
    try:
        work()
    except Exception as error:
        reason = str(error) or type(error).__name__
        with contextlib.suppress(Exception):  # a control that has gone meanwhile
            failed(reason)
