"""Ports that carry bytes to and from a rig: a serial port, or an emulated rig in this process."""

import os
from typing import Protocol

import serial
from serial.tools.list_ports import comports

from furuta_hw.connection.rig_driver import READ_TIMEOUT
from furuta_hw.errors import LineError, line_errors
from furuta_hw.rigs.rig import Rig

# The port name that stands for an emulated rig in this process.
MOCK = "mock"


class Port(Protocol):
    """Carries bytes. ``read`` and ``write`` may be called from two threads."""

    def read(self) -> bytes:
        """Wait for bytes for at most :data:`READ_TIMEOUT` and return them; empty if none came."""

    def write(self, data: bytes) -> None:
        """Send; raises :class:`LineError` if the line does not accept all bytes."""

    def close(self) -> None:
        """Free the port."""


class SerialPort:
    """A serial port through pyserial, held exclusively."""

    def __init__(self, port: str, baud: int) -> None:
        with line_errors(f"cannot open {port}", lambda: _others(port)):
            self._port = serial.Serial(port, baud, timeout=READ_TIMEOUT, exclusive=True)
            self._port.reset_input_buffer()

    def read(self) -> bytes:
        """Wait for bytes and return them."""
        with line_errors():
            return bytes(self._port.read(1) + self._port.read(self._port.in_waiting))

    def write(self, data: bytes) -> None:
        """Send without waiting: a line without room for a frame is too slow to drive a rig."""
        with line_errors("the line does not accept data"):
            sent = os.write(self._port.fileno(), data)
        if sent < len(data):
            raise LineError("the line does not accept data: its buffer is full")

    def close(self) -> None:
        """Free the port."""
        self._port.close()


def _others(port: str) -> str:
    """What a message about ``port`` ends with if this computer has no such serial port."""
    names = sorted(each.device for each in comports())
    if port in names or os.path.exists(port):
        return ""
    return f"; serial ports are {', '.join(names)}" if names else "; there is no serial port"


def open_port(name: str, rig: Rig) -> Port:
    """Open the serial port of that name, or the mock. Raises :class:`LineError`."""
    if name == MOCK:
        # A real rig needs no simulation, so it is imported only here.
        from furuta_hw.emulator.emulated_rig import MockPort  # noqa: PLC0415

        return MockPort(rig)
    if not name:
        raise LineError("no port given; name the serial port, or mock")
    return SerialPort(name, rig.line.baud)
