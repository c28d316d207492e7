"""A thread that makes slow calls in order; of several waiting with one key only the newest runs."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import TypeAlias

Job: TypeAlias = Callable[[], None]


class Jobs:
    """Runs jobs in a thread of its own. A job handles its own errors."""

    def __init__(self) -> None:
        self._waiting: OrderedDict[Hashable, Job] = OrderedDict()
        self._changed = threading.Condition()
        self._running: Hashable = None
        self._ended = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def submit(self, key: Hashable, job: Job) -> None:
        """Run a job after those that wait; it replaces a waiting one with the same key."""
        with self._changed:
            self._waiting[key] = job
            self._changed.notify()

    def pending(self, key: Hashable) -> bool:
        """Whether a job with this key waits or runs."""
        with self._changed:
            return key in self._waiting or key == self._running

    def close(self, timeout: float) -> None:
        """Forget what waits, and wait up to ``timeout`` [s] for the job that runs."""
        with self._changed:
            self._waiting.clear()
            self._ended = True
            self._changed.notify()
        self._thread.join(timeout)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._running = None
                self._changed.wait_for(lambda: self._waiting or self._ended)
                if self._ended:
                    return
                self._running, job = self._waiting.popitem(last=False)
            job()
