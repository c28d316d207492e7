"""What carries bytes to and from a rig: a serial line, or a mock in this process."""

from __future__ import annotations

import os
from time import monotonic, sleep
from typing import Protocol

import serial

from furuta_hw.emulated import EmulatedRig
from furuta_hw.errors import LineError
from furuta_hw.rig import Rig

# Longest wait for bytes [s].
READ_TIMEOUT = 0.05
# The name of the port that is no port.
MOCK = "mock"


class Backend(Protocol):
    """Bytes to and from a rig. ``read`` and ``write`` may be called from two threads."""

    def read(self) -> bytes:
        """What has come, after a wait of at most :data:`READ_TIMEOUT`; may be nothing."""

    def write(self, data: bytes) -> None:
        """Send; raises :class:`LineError` if the line does not take it."""

    def close(self) -> None:
        """Free the port."""


class SerialBackend:
    """A serial port through pyserial, held exclusively."""

    def __init__(self, port: str, baud: int) -> None:
        try:
            self._port = serial.Serial(port, baud, timeout=READ_TIMEOUT, exclusive=True)
            self._port.reset_input_buffer()
        except (serial.SerialException, OSError, ValueError) as error:
            raise LineError(f"cannot open {port}: {_reason(error)}") from None

    def read(self) -> bytes:
        """What has come."""
        try:
            return bytes(self._port.read(1) + self._port.read(self._port.in_waiting))
        except (serial.SerialException, OSError, TypeError) as error:
            raise LineError(f"the line broke: {_reason(error)}") from None

    def write(self, data: bytes) -> None:
        """Send without waiting: a line that has no room for a frame is none to drive by."""
        try:
            sent = os.write(self._port.fileno(), data)
        except (serial.SerialException, OSError) as error:
            raise LineError(f"the line takes nothing: {_reason(error)}") from None
        if sent < len(data):
            raise LineError("the line takes nothing: no room")

    def close(self) -> None:
        """Free the port."""
        self._port.close()


class MockBackend:
    """An emulated rig in this process, which lives while it is read."""

    def __init__(self, rig: EmulatedRig, period: float) -> None:
        self._rig = rig
        self._period = period
        self._next = monotonic() + period

    def read(self) -> bytes:
        """The next sample, when it is due."""
        sleep(max(0.0, self._next - monotonic()))
        self._next = max(self._next + self._period, monotonic())
        return self._rig.tick()

    def write(self, data: bytes) -> None:
        """Hand over to the rig."""
        self._rig.receive(data)

    def close(self) -> None:
        """Nothing to free."""


def open_backend(port: str, rig: Rig) -> Backend:
    """The serial port of that name, or the mock. Raises :class:`LineError`."""
    if port == MOCK:
        return MockBackend(EmulatedRig(rig), rig.line.sample_time)
    if not port:
        raise LineError("no port given; name the serial port, or mock")
    return SerialBackend(port, rig.line.baud)


def _reason(error: Exception) -> str:
    """The system's words rather than pyserial's, which repeat the port."""
    number = getattr(error, "errno", None)
    return os.strerror(number) if number else str(error)
