"""Hands messages to a process of its own that writes them into a bag.

A recorder writes bytes into a pipe and continues: neither a slow disk nor Python's interpreter
lock makes it wait. The operating system keeps what is in the pipe. If the recorder is killed, the
writer still writes the rest and finishes the bag.
"""

import fcntl
import os
import select
import subprocess
import sys
from collections import deque
from contextlib import suppress
from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.metadata import BagTopic
from furuta_recordings.bags.pipe_protocol import PIPE_CAPACITY, READY, header_frame, message_head

# Most bytes that may wait for space in the pipe; a disk that needs more is too slow.
LARGEST_BACKLOG = 2**26
WRITER = "furuta_recordings.bags.writer_process"


class BackgroundWriter:
    """The recorder's end of the pipe.

    The bag is on the disk after construction; raises :class:`ParameterError` if it cannot be
    created. ``failure`` is the reason if writing ended early.
    """

    def __init__(self, path: Path, topics: list[BagTopic], parameters: dict[str, str]) -> None:
        self.path = path
        self.failure: str | None = None
        self._added: list[bytes] = [header_frame(topics, parameters)]
        self._backlog: deque[memoryview] = deque()
        self._process = subprocess.Popen(
            [sys.executable, "-m", WRITER, str(path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C must not reach it: it ends with the pipe
        )
        assert self._process.stdin is not None
        self._pipe = self._process.stdin.fileno()
        with suppress(OSError):  # the user's quota for pipes may be exhausted
            fcntl.fcntl(self._pipe, fcntl.F_SETPIPE_SZ, PIPE_CAPACITY)
        os.set_blocking(self._pipe, False)
        self.send(wait=True)
        self._wait_until_ready()

    def _wait_until_ready(self) -> None:
        answer = self._answer()
        if answer != READY:
            self._process.wait()
            raise ParameterError(answer)

    def add(self, topic: int, time: int, data: bytes) -> None:
        """Take a message of one of the topics (index), received at ``time`` [ns]."""
        self._added += (message_head(topic, time, data), data)

    def send(self, wait: bool = False) -> None:
        """Send what was added: as much as the pipe has space for or, with ``wait``, everything."""
        if self._added:
            self._backlog.append(memoryview(b"".join(self._added)))
            self._added.clear()
        while self._backlog and self.failure is None and self._write_some(wait):
            pass
        if sum(map(len, self._backlog)) > LARGEST_BACKLOG:
            self.failure = f"{self.path}: the disk is too slow for this recording"
        if self.failure is not None:
            self._backlog.clear()

    def _write_some(self, wait: bool) -> bool:
        """Write from the backlog into the pipe; False if the pipe is full and ``wait`` is not."""
        try:
            written = os.write(self._pipe, self._backlog[0])
        except BlockingIOError:
            if wait:
                select.select([], [self._pipe], [])
            return wait
        except BrokenPipeError:
            self.failure = self._answer()
            return False
        self._backlog[0] = self._backlog[0][written:]
        if not self._backlog[0]:
            self._backlog.popleft()
        return True

    def close(self) -> None:
        """Send what is left and wait until the bag is finished; may be called twice."""
        assert self._process.stdin is not None
        if self._process.stdin.closed:
            return
        self.send(wait=True)
        self._process.stdin.close()
        if self._process.wait() and self.failure is None:
            self.failure = self._answer()

    def _answer(self) -> str:
        """The writer's next line; its last one is the reason why it ended."""
        assert self._process.stdout is not None
        line = self._process.stdout.readline().decode().strip()
        return line or f"{self.path}: the process that wrote it was killed"
