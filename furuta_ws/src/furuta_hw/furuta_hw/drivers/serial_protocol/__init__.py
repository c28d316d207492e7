"""The bundled driver: the serial protocol of docs/hardware.md."""

from furuta_hw.drivers.serial_protocol.driver import SerialProtocolDriver as Driver

__all__ = ["Driver"]
