"""A bag written by a process of its own, which is fed through a pipe.

Who records hands over bytes and goes on: it shares neither a slow disk nor the interpreter with
the writer. What is in the pipe is the system's, so when the recording process is killed the
writer writes the rest and finishes the bag.

Both ends are here: :class:`BagProcess`, and :func:`main` of the process that writes.
"""

from __future__ import annotations

import fcntl
import json
import os
import select
import struct
import subprocess
import sys
from collections import deque
from contextlib import suppress
from pathlib import Path
from time import monotonic, sleep

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.mcap_file import Kind
from furuta_recordings.bags.writer import BagWriter

# Bytes that the pipe holds: a second of the graph at 1 kHz.
PIPE = 2**20
# Bytes that wait for room in the pipe at most; a disk that needs more does not keep up.
LONGEST_WAIT = 2**26
# Seconds that the writer sleeps where no more than LITTLE [bytes] came: so nobody has to wake it.
TURN = 0.02
LITTLE = 2**16
# Seconds between two times that the writer makes last what it was given.
LASTING = 0.1
READY = "ready"
_FRAME = struct.Struct("<IHQ")  # length of the data, kind, time [ns]


class BagProcess:
    """The end of who records.

    The bag is on the disk once this is made; raises :class:`ParameterError` if it cannot be.
    ``failure`` says why writing ended before its time.
    """

    def __init__(self, path: Path, kinds: list[Kind], parameters: dict[str, str]) -> None:
        self.path = path
        self.failure: str | None = None
        self._added: list[bytes] = []
        self._waiting: deque[memoryview] = deque()
        self._process = subprocess.Popen(
            [sys.executable, "-m", __name__, str(path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # out of Ctrl-C's reach: its end is the pipe's
        )
        assert self._process.stdin is not None
        self._pipe = self._process.stdin.fileno()
        with suppress(OSError):  # a user may have as much of pipes as is allowed
            fcntl.fcntl(self._pipe, fcntl.F_SETPIPE_SZ, PIPE)
        os.set_blocking(self._pipe, False)
        self.add(0, 0, json.dumps([kinds, parameters]).encode())
        self.send(wait=True)
        answer = self._said()
        if answer != READY:
            self._process.wait()
            raise ParameterError(answer)

    def add(self, kind: int, time: int, data: bytes) -> None:
        """Take a message of one of the kinds (index), received at ``time`` [ns]."""
        self._added += (_FRAME.pack(len(data), kind, time), data)

    def send(self, wait: bool = False) -> None:
        """Hand over what was added: what there is room for or, with ``wait``, all of it."""
        if self._added:
            self._waiting.append(memoryview(b"".join(self._added)))
            self._added.clear()
        while self._waiting and self.failure is None:
            try:
                written = os.write(self._pipe, self._waiting[0])
            except BlockingIOError:
                if not wait:
                    break
                select.select([], [self._pipe], [])
            except BrokenPipeError:
                self.failure = self._said()
            else:
                self._waiting[0] = self._waiting[0][written:]
                if not self._waiting[0]:
                    self._waiting.popleft()
        if sum(map(len, self._waiting)) > LONGEST_WAIT:
            self.failure = f"{self.path}: the disk does not keep up"
        if self.failure is not None:
            self._waiting.clear()

    def close(self) -> None:
        """Hand over what is left and wait until the bag is finished; a second time does nothing."""
        assert self._process.stdin is not None
        if self._process.stdin.closed:
            return
        self.send(wait=True)
        self._process.stdin.close()
        if self._process.wait() and self.failure is None:
            self.failure = self._said()

    def _said(self) -> str:
        """What the writer says next; the last is why it ended."""
        assert self._process.stdout is not None
        line = self._process.stdout.readline().decode().strip()
        return line or f"{self.path}: the process that wrote it was ended"


def main(path: Path) -> int:
    """Write what comes through standard input until it ends; returns the exit status."""
    # Its share of time is as any other's, but when it wakes it takes no core from the loop; and a
    # real-time priority is for the loop alone.
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    length, _, _ = _FRAME.unpack(_exactly(_FRAME.size))
    kinds, parameters = json.loads(_exactly(length))
    try:
        writer = BagWriter(path, [Kind(*kind) for kind in kinds], parameters)
        print(READY, flush=True)
        _write(writer)
    except ParameterError as error:
        print(error, flush=True)
        return 1
    except OSError as error:
        print(f"{error.filename or path}: {error.strerror}", flush=True)
        return 1
    return 0


def _exactly(length: int) -> bytes:
    data = b""
    while len(data) < length:
        data += os.read(0, length - len(data)) or sys.exit(1)
    return data


def _write(writer: BagWriter) -> None:
    """Write frames until the pipe's other end is closed, by whatever."""
    os.set_blocking(0, False)
    rest, lasting = b"", 0.0
    while True:
        try:
            data = os.read(0, PIPE)
            if not data:
                break
        except BlockingIOError:
            data = b""
        rest = _add(writer, rest + data)
        if writer.waiting and monotonic() - lasting >= LASTING:
            writer.flush()
            lasting = monotonic()
        if len(data) <= LITTLE:
            sleep(TURN)
    writer.close()


def _add(writer: BagWriter, data: bytes) -> bytes:
    """Give the writer every whole frame; returns the part of one at the end."""
    at = 0
    while len(data) - at >= _FRAME.size:
        length, kind, time = _FRAME.unpack_from(data, at)
        end = at + _FRAME.size + length
        if end > len(data):
            break
        writer.add(kind, time, data[at + _FRAME.size : end])
        at = end
    return data[at:]


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
