"""Writes a bag in a thread of its own, so that a slow disk does not make the recorder wait."""

import os
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import suppress
from pathlib import Path
from time import monotonic

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.metadata import BagTopic
from furuta_recordings.bags.writer import BagWriter, Row

# Time [s] between two flushes to the disk.
FLUSH_INTERVAL = 0.1
# Most bytes that may wait for the disk; if more must, it is too slow.
LARGEST_BACKLOG = 2**26


class BackgroundWriter:
    """Hands messages to the thread that writes them into the bag ``path``.

    The bag is on the disk after construction; raises :class:`ParameterError` if it cannot be
    created. ``failure`` is the reason if writing ended early. sqlite3 releases Python's lock while
    it writes.
    """

    def __init__(self, path: Path, topics: list[BagTopic], parameters: dict[str, str]) -> None:
        self.path = path
        self.failure: str | None = None
        self._rows: list[Row] = []
        self._bytes = 0
        self._next_flush = 0.0
        self.closed = False
        try:
            self._writer = BagWriter(path, topics, parameters)
        except OSError as error:
            raise ParameterError(self._reason(error)) from None
        self._thread = ThreadPoolExecutor(1, initializer=_use_ordinary_scheduling)
        self._writing: Future[None] = self._thread.submit(self._writer.write, [])

    def add(self, topic: int, time: int, data: bytes) -> None:
        """Take a message of one of the topics (index), received at ``time`` [ns]."""
        self._rows.append((topic, time, data))
        self._bytes += len(data)

    def send(self, wait_for_disk: bool = False) -> None:
        """Begin to write what was added, if the last flush was long enough ago.

        With ``wait_for_disk`` a backlog that is too large waits for the disk, otherwise it ends
        the recording.
        """
        too_large = self._bytes > LARGEST_BACKLOG
        if wait_for_disk and too_large:
            wait([self._writing])
        if self._writing.done():
            if too_large or monotonic() >= self._next_flush:
                self._flush()
        elif too_large:
            self.failure = f"{self.path}: the disk is too slow for this recording"

    def _flush(self) -> None:
        self._check()
        rows, self._rows, self._bytes = self._rows, [], 0
        if self.failure is None and rows:
            self._writing = self._thread.submit(self._writer.write, rows)
            self._next_flush = monotonic() + FLUSH_INTERVAL

    def _check(self) -> None:
        """Wait for the flush that was begun; take note of its failure."""
        error = self._writing.exception()
        if error is not None and self.failure is None:
            self.failure = self._reason(error)

    def close(self) -> None:
        """Write what is left and finish the bag; may be called twice."""
        if self.closed:
            return
        self.closed = True
        self._flush()
        self._check()
        self._writing = self._thread.submit(self._writer.close)
        self._check()
        self._thread.shutdown()

    def _reason(self, error: BaseException) -> str:
        if isinstance(error, OSError):
            return f"{error.filename or self.path}: {error.strerror}"
        return f"{self.path}: {error}"


def _use_ordinary_scheduling() -> None:
    """Do not inherit the real-time priority of the control loop, and never preempt it."""
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
