"""Keeps a rig driver running: reads on a thread, and reconnects when the line fails."""

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Thread
from time import monotonic
from typing import Any

from furuta_hw.connection.rig_driver import LineStatistics, RigDriver, RigSample
from furuta_hw.errors import LineError, driver_errors

# Late samples are passed on because filters count on them, but no more than this many at once.
MAX_BATCH = 20
# Time between two attempts to open a failed line, or to restart a silent rig [s].
RETRY_PERIOD = 1.0


class RigConnection:
    """An open line to a rig.

    The thread only waits for data. It calls ``data_arrived`` when there are some, and
    :meth:`samples` decodes them in the caller's own thread.
    """

    def __init__(self, driver: RigDriver, data_arrived: Callable[[], None]) -> None:
        self._driver = driver
        self._data_arrived = data_arrived
        self.connected = False
        self.failure = ""  # why the line is not connected
        self.skipped_samples = 0  # samples beyond MAX_BATCH that arrived at once
        self._inbox: deque[Any] = deque()
        self._read_error: LineError | None = None
        self._thread: Thread | None = None
        self._closing = False
        self._bad_frames = 0
        self._retry_at = 0.0

    def open(self) -> None:
        """Open the line. Raises :class:`LineError`."""
        with driver_errors():
            self._driver.open()
        self._inbox.clear()
        self._bad_frames = 0
        self.connected, self.failure = True, ""
        self._start_reading()
        self._schedule_retry()

    def samples(self) -> list[RigSample]:
        """Return the new samples in order, at most :data:`MAX_BATCH`.

        To be called every few milliseconds: it also opens a failed line again. Raises
        :class:`LineError` once when the line fails, and when a silent rig is restarted. In both
        cases the rig is not armed afterwards, and the numbers of its samples start again.
        """
        if not self.connected:
            self._reopen_when_due()
            return []
        with self._closed_on_failure():
            samples = self._decode_inbox()
        if samples:
            self._schedule_retry()
        elif monotonic() > self._retry_at:
            self._restart()
        self.skipped_samples += max(0, len(samples) - MAX_BATCH)
        return samples[-MAX_BATCH:]

    def arm(self) -> None:
        """Arm the rig. Raises :class:`LineError`."""
        with self._closed_on_failure(), driver_errors():
            self._driver.arm()

    def drive(self, volts: float) -> None:
        """Apply a voltage [V]. Raises :class:`LineError`."""
        if self.connected:
            with self._closed_on_failure(), driver_errors():
                self._driver.drive(volts)

    def stop(self) -> None:
        """Disarm the rig and set it to 0 V. If the line fails, the rig's watchdog stops it."""
        if self.connected:
            with suppress(LineError), driver_errors():
                self._driver.stop()

    def close(self) -> None:
        """End the thread and close the line."""
        if self.connected:
            self.connected = False
            self._stop_reading()
            with suppress(LineError), driver_errors():
                self._driver.close()

    def statistics(self) -> LineStatistics:
        """Return the driver's statistics."""
        return self._driver.statistics()

    def new_bad_frames(self) -> int:
        """Return the number of bad frames since the last call."""
        before, self._bad_frames = self._bad_frames, self._driver.statistics().bad
        return self._bad_frames - before

    def _decode_inbox(self) -> list[RigSample]:
        samples: list[RigSample] = []
        while self._inbox:
            samples += self._driver.decode(self._inbox.popleft())
        if self._read_error is not None and not samples:
            raise self._read_error
        return samples

    @contextmanager
    def _closed_on_failure(self) -> Iterator[None]:
        """Stop the rig and close the line if it fails."""
        try:
            yield
        except LineError as error:
            self.stop()
            self.close()
            self.failure = str(error)
            self._schedule_retry()
            raise

    def _reopen_when_due(self) -> None:
        if monotonic() > self._retry_at:
            try:
                self.open()
            except LineError as error:
                self.failure = str(error)
                self._schedule_retry()

    def _restart(self) -> None:
        self._stop_reading()
        try:
            with driver_errors():
                self._driver.restart()
        except LineError as error:
            self.connected, self.failure = False, str(error)
            self._schedule_retry()
            raise
        self._inbox.clear()
        self._bad_frames = self._driver.statistics().bad  # some drivers count from 0 again
        self._start_reading()
        self._schedule_retry()
        raise LineError(f"no sample for {RETRY_PERIOD:g} s")

    def _schedule_retry(self) -> None:
        self._retry_at = monotonic() + RETRY_PERIOD

    def _start_reading(self) -> None:
        self._closing, self._read_error = False, None
        self._thread = Thread(target=self._read, name="rig line", daemon=True)
        self._thread.start()

    def _stop_reading(self) -> None:
        self._closing = True
        if self._thread is not None:
            self._thread.join()

    def _read(self) -> None:
        while not self._closing:
            try:
                with driver_errors():
                    if data := self._driver.read():
                        self._inbox.append(data)
                        self._data_arrived()
            except LineError as error:
                self._read_error = error
                self._data_arrived()
                return
