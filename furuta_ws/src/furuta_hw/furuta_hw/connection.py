"""An open line to a rig with a thread that reads it, for a node whose executor must not wait."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from threading import Thread

from furuta_hw.backend import Backend, open_backend
from furuta_hw.errors import LineError
from furuta_hw.frames import Sensors
from furuta_hw.host import Host
from furuta_hw.rig import Rig
from furuta_hw.sensing import Sensing

# Longest wait for the rig's answer at the start [s].
TIMEOUT = 3.0
# Samples that came late are passed on, for filters count on them; more than this are history.
MOST = 20


class Connection:
    """Raises :class:`LineError` if the rig does not answer.

    The thread does nothing but wait for bytes; it calls ``arrived`` from there once there are
    some, and :meth:`take` decodes them in the caller's own thread.
    """

    def __init__(self, port: str, rig: Rig, arrived: Callable[[], None]) -> None:
        self._backend: Backend = open_backend(port, rig)
        self.host = Host(self._backend, rig)
        self._rig = rig
        self.sensing = Sensing(rig)
        self.skipped = 0  # samples that came in one go with so many newer ones
        self._arrived = arrived
        self._inbox: deque[bytes] = deque()
        self._error: LineError | None = None
        self._closing = False
        try:
            self.host.connect(TIMEOUT)
        except LineError:
            self._backend.close()
            raise
        self._thread = Thread(target=self._read, name="serial line", daemon=True)
        self._thread.start()

    def _read(self) -> None:
        while not self._closing:
            try:
                data = self._backend.read()
            except LineError as error:
                self._error = error
                self._arrived()
                return
            if data:
                self._inbox.append(data)
                self._arrived()

    def take(self) -> list[Sensors]:
        """The samples since the last call, in order, :data:`MOST` at most; or the line's error."""
        samples: list[Sensors] = []
        while self._inbox:
            samples += self.host.receive(self._inbox.popleft())
        if self._error is not None and not samples:
            raise self._error
        self.skipped += max(0, len(samples) - MOST)
        return samples[-MOST:]

    def begin_anew(self) -> None:
        """Ask a rig that has fallen silent, or was switched off and on, for a new session."""
        self.sensing = Sensing(self._rig)
        self.host.hello()

    def close(self) -> None:
        """End the thread and free the port."""
        self._closing = True
        self._thread.join()
        self._backend.close()
