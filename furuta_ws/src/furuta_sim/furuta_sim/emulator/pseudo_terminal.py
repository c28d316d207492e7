"""The emulated rig's end of a pseudo-terminal."""

from __future__ import annotations

import os
import select
import tty


class PseudoTerminal:
    """A pseudo-terminal; the host opens ``name`` like a serial port."""

    def __init__(self) -> None:
        # This process keeps the other end open too: reads fail while it is closed.
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.name = os.ttyname(self._slave)

    def read(self, wait: float = 0.0) -> bytes:
        """Return the received bytes, after a wait of at most ``wait`` [s]."""
        if wait > 0.0:
            select.select([self._master], [], [], wait)
        try:
            return os.read(self._master, 65536)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> None:
        """Send; bytes are lost if the buffer is full, as on a serial line without a reader."""
        try:
            os.write(self._master, data)
        except BlockingIOError:
            return
