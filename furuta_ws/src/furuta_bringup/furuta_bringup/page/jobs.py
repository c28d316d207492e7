"""A thread that makes slow calls in order; of several waiting with one key only the newest runs."""

import contextlib
import threading
import traceback
from collections.abc import Callable, Hashable
from queue import SimpleQueue
from typing import TypeAlias

from furuta_model.parameters import ParameterError
from furuta_ros.errors import UserError

Work: TypeAlias = Callable[[], None]
Failed: TypeAlias = Callable[[str], None]


class Jobs:
    """Does work in a thread of its own."""

    def __init__(self) -> None:
        self._newest: dict[Hashable, tuple[Work, Failed]] = {}
        self._keys: SimpleQueue[Hashable] = SimpleQueue()
        self._running: Hashable = None
        threading.Thread(target=self._run, daemon=True).start()

    def submit(self, key: Hashable, work: Work, failed: Failed = lambda reason: None) -> None:
        """Do ``work`` after what waits; it replaces what waits with the same key.

        If it raises an exception, ``failed`` is called with the reason.
        """
        self._newest[key] = work, failed
        self._keys.put(key)

    def pending(self, key: Hashable) -> bool:
        """Whether work with this key waits or runs."""
        return key in self._newest or key == self._running

    def finish(self, timeout: float) -> None:
        """Wait up to ``timeout`` [s] until what waits now is done."""
        done = threading.Event()
        self.submit(done, done.set)
        done.wait(timeout)

    def close(self, timeout: float) -> None:
        """Forget what waits, and wait up to ``timeout`` [s] for what runs."""
        self._newest.clear()
        self.finish(timeout)

    def _run(self) -> None:
        while True:
            self._running = key = self._keys.get()
            work, failed = self._newest.pop(key, (None, None))
            if work is not None and failed is not None:
                _do(work, failed)
            self._running = None


def _do(work: Work, failed: Failed) -> None:
    """Do work; the thread goes on, whatever happens. An error that nobody expects is printed."""
    try:
        work()
    except Exception as error:
        if not isinstance(error, UserError | ParameterError):
            traceback.print_exc()
        reason = str(error) or type(error).__name__
        with contextlib.suppress(Exception):  # a control that has gone meanwhile
            failed(reason)
