"""A pseudo-terminal between the bridge and the emulated rig that damages bytes in transit."""

from __future__ import annotations

import os
import select
import tty
from collections import Counter
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread

import numpy as np

from soak.mutators import damaged_bytes

# Longest wait for bytes before the end is checked [s], and the most bytes read at once.
WAIT, MOST = 0.1, 65536
# Priority of its thread in the real-time scheduler.
PRIORITY = 10


class LineRelay:
    """The host opens ``link``; the rig is at ``port``. ``damaged`` is the damaged fraction.

    Bytes are damaged as they are read, about one frame at a time.
    """

    def __init__(self, port: Path, link: Path, random: np.random.Generator) -> None:
        self.damaged = 0.0
        self.counts: Counter[str] = Counter()
        self._random = random
        # The other end stays open here too: reads fail while it is closed.
        self._host, self._other_end = os.openpty()
        self._rig = os.open(port, os.O_RDWR | os.O_NOCTTY)
        for end in (self._other_end, self._rig):
            tty.setraw(end)
        for end in (self._host, self._rig):
            os.set_blocking(end, False)
        link.symlink_to(os.ttyname(self._other_end))
        self._ended = Event()
        self._thread = Thread(target=self._carry, name="relay", daemon=True)
        self._thread.start()

    def _carry(self) -> None:
        # Like the emulated rig: the line is no slower under load, if the system permits it.
        with suppress(PermissionError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
        while not self._ended.is_set():
            ready, _, _ = select.select([self._host, self._rig], [], [], WAIT)
            if self._host in ready:
                self._pass_on(self._host, self._rig, "to rig")
            if self._rig in ready:
                self._pass_on(self._rig, self._host, "to host")

    def _pass_on(self, source: int, sink: int, direction: str) -> None:
        data = self._damage(os.read(source, MOST), direction)
        with suppress(BlockingIOError):  # lost, as on a line without a reader
            os.write(sink, data)

    def _damage(self, data: bytes, direction: str) -> bytes:
        if data and self._random.random() < self.damaged:
            data, kind = damaged_bytes(self._random, data)
            self.counts[f"frame {kind} {direction}"] += 1
        return data

    def close(self) -> None:
        """End the thread."""
        self._ended.set()
        self._thread.join()
        for end in (self._host, self._other_end, self._rig):
            os.close(end)
