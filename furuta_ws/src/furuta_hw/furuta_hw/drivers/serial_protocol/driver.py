"""The rig driver for the serial protocol of docs/hardware.md."""

from furuta_hw.connection.rig_driver import LineStatistics, RigDriver, RigSample
from furuta_hw.drivers.serial_protocol.conversion import SampleConverter
from furuta_hw.drivers.serial_protocol.host import ProtocolHost
from furuta_hw.drivers.serial_protocol.ports import Port, open_port
from furuta_hw.errors import LineError

# Longest wait for the rig's answer when the line is opened [s].
CONNECT_TIMEOUT = 3.0


class SerialProtocolDriver(RigDriver):
    """Talks to a rig on a serial port, or to an emulated rig in this process (port ``mock``)."""

    _port: Port
    _host: ProtocolHost
    _converter: SampleConverter

    def open(self) -> None:
        """Open the port and start a session."""
        self._port = open_port(self.port, self.rig)
        self._host = ProtocolHost(self._port, self.rig)
        self._converter = SampleConverter(self.rig)
        try:
            self._host.connect(CONNECT_TIMEOUT)
        except LineError:
            self._port.close()
            raise

    def close(self) -> None:
        """Close the port."""
        self._port.close()

    def read(self) -> bytes:
        """Wait for bytes and return them."""
        return self._port.read()

    def decode(self, data: bytes) -> list[RigSample]:
        """Convert bytes to the samples that they complete."""
        return [self._converter.convert(frame) for frame in self._host.receive(data)]

    def arm(self) -> None:
        """Arm the rig."""
        self._host.arm()

    def drive(self, volts: float) -> None:
        """Send the voltage [V] as a DA code."""
        self._host.drive(self.rig.drive.channel.to_code(volts))

    def stop(self) -> None:
        """Disarm the rig and set it to 0 V."""
        self._host.stop()

    def restart(self) -> None:
        """Start a new session on the open port."""
        self._converter = SampleConverter(self.rig)
        try:
            self._host.start_session()
        except LineError:
            self._port.close()
            raise

    def statistics(self) -> LineStatistics:
        """Return the frames counted since the port was opened."""
        return self._host.statistics()
