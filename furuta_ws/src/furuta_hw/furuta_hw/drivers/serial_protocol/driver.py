"""The rig driver for the serial protocol of docs/hardware.md: sessions, statistics, samples."""

from math import exp
from secrets import randbits
from time import monotonic

from furuta_hw.connection.rig_driver import LineStatistics, RawCodes, RigDriver, RigSample
from furuta_hw.drivers.serial_protocol.ports import open_port
from furuta_hw.errors import LineError
from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import (
    ARMED,
    FAULT,
    WATCHDOG,
    FrameReader,
    SensorsFrame,
    WelcomeFrame,
    encode,
    is_newer,
)
from furuta_hw.rigs.channels import wrapped
from furuta_hw.rigs.rig import Rig

# Longest wait for the rig's answer when the line is opened, and time between two attempts [s].
CONNECT_TIMEOUT, RETRY_PERIOD = 3.0, 0.1


class SerialProtocolDriver(RigDriver):
    """Talks to a rig on a serial port, or to an emulated rig in this process (port ``mock``).

    A session starts with Hello and has a random number, so that frames of an earlier session that
    are still in a buffer are recognised and ignored.
    """

    _welcome: WelcomeFrame | None = None

    def open(self) -> None:
        """Open the port and start a session."""
        self._port = open_port(self.port, self.rig)
        self._reader = FrameReader()
        self._received = self._lost = self._repeated = self._other_sessions = 0
        self._discarded_by_rig = 0
        try:
            self._connect()
        except LineError:
            self.close()
            raise

    def close(self) -> None:
        """Close the port."""
        self._port.close()

    def read(self) -> bytes:
        """Wait for bytes and return them."""
        return self._port.read()

    def decode(self, data: bytes) -> list[RigSample]:
        """Convert bytes to the samples that they complete."""
        samples = []
        for frame in self._reader.read(data):
            if getattr(frame, "session", None) != self._session:
                self._other_sessions += 1
            elif isinstance(frame, WelcomeFrame):
                self._welcome = frame
            elif isinstance(frame, SensorsFrame) and self._welcome and self._count(frame):
                samples.append(self._converter.convert(frame))
        return samples

    def arm(self) -> None:
        """Arm the rig."""
        self._port.write(encode(frames.ArmFrame(self._session, self._sample)))

    def drive(self, volts: float) -> None:
        """Send the voltage [V] as a DA code, in answer to the newest sample."""
        code = self.rig.drive.channel.to_code(volts)
        self._port.write(encode(frames.DriveFrame(self._session, self._sample, code)))

    def stop(self) -> None:
        """Disarm the rig and set it to 0 V."""
        self._port.write(encode(frames.StopFrame(self._session)))

    def restart(self) -> None:
        """Start a new session on the open port."""
        try:
            self._start_session()
        except LineError:
            self.close()
            raise

    def _start_session(self) -> None:
        """Ask the rig for a new session."""
        self._converter = SampleConverter(self.rig)
        self._session = randbits(16)
        self._sample = self._discarded = 0  # the newest sample, and what it says was discarded
        self._welcome = None
        rig = self.rig
        hello = frames.HelloFrame(
            frames.VERSION, self._session, rig.period_us, rig.watchdog_samples
        )
        # The leading zero ends a frame that an earlier host may have left incomplete.
        self._port.write(b"\0" + encode(hello))

    def statistics(self) -> LineStatistics:
        """Return the frames counted since the port was opened."""
        return LineStatistics(
            self._lost,
            self._reader.corrupt,
            self._repeated,
            self._other_sessions,
            self._discarded_by_rig,
        )

    def _connect(self) -> None:
        """Ask for a session until the rig answers.

        Raises :class:`LineError` if it does not, or has another version, period or watchdog.
        """
        end = monotonic() + CONNECT_TIMEOUT
        while monotonic() < end:
            self._start_session()
            attempt_end = monotonic() + RETRY_PERIOD
            while monotonic() < attempt_end:
                self.decode(self._port.read())
                if self._welcome is not None:
                    self._check_agreement(self._welcome)
                    return
        raise LineError(
            f"no answer within {CONNECT_TIMEOUT:g} s: no rig, a different baud rate, or no power"
        )

    def _check_agreement(self, welcome: WelcomeFrame) -> None:
        """Raise :class:`LineError` if the rig offers something else than its file requires."""
        rig = self.rig
        if welcome.version != frames.VERSION:
            raise LineError(
                f"the rig uses version {welcome.version} of the protocol, this is version "
                f"{frames.VERSION}"
            )
        if (welcome.period_us, welcome.watchdog) != (rig.period_us, rig.watchdog_samples):
            raise LineError(
                f"the rig offers {welcome.period_us} µs and a watchdog of {welcome.watchdog} "
                f"samples, the rig file requires {rig.period_us} µs and {rig.watchdog_samples}"
            )

    def _count(self, frame: SensorsFrame) -> bool:
        """Update the statistics; False for a sample that was received before."""
        if not is_newer(frame.sample, self._sample):
            self._repeated += 1
            return False
        if self._received:
            self._lost += (frame.sample - self._sample - 1) % 2**32
        self._received += 1
        self._sample = frame.sample
        self._discarded_by_rig += (frame.discarded - self._discarded) % 2**16
        self._discarded = frame.discarded
        return True


class SampleConverter:
    """Converts the frames of one session, in order.

    Without a tachometer the arm speed is the difference of the arm's angles behind a first-order
    low-pass filter, exact for gaps of any number of samples.
    """

    def __init__(self, rig: Rig) -> None:
        self._arm, self._speed = rig.arm.channel, rig.speed.channel
        self._pendulum, self._drive = rig.pendulum.channel, rig.drive.channel
        self._has_tachometer = rig.speed.sensor == "tachometer"
        self._has_potentiometer = rig.pendulum.sensor == "potentiometer"
        self._dt = rig.line.sample_time
        self._decay = rig.speed.bandwidth * rig.line.sample_time
        self._last_number: int | None = None
        self._arm_angle = self._arm_speed = 0.0

    def convert(self, frame: SensorsFrame) -> RigSample:
        """Convert the next frame."""
        arm_angle = self._arm.to_si(frame.arm)
        if self._has_tachometer:
            self._arm_speed = self._speed.to_si(frame.speed)
        else:
            self._filter_speed(arm_angle, frame.sample)
        self._arm_angle, self._last_number = arm_angle, frame.sample
        return RigSample(
            frame.sample,
            arm_angle,
            self._arm_speed,
            wrapped(self._pendulum.to_si(frame.pendulum)),
            self._drive.to_si(frame.drive),
            bool(frame.status & ARMED),
            bool(frame.status & FAULT),
            bool(frame.status & WATCHDOG),
            (self._has_tachometer and self._speed.at_rail(frame.speed))
            or (self._has_potentiometer and self._pendulum.at_rail(frame.pendulum)),
            RawCodes(frame.arm, frame.speed, frame.pendulum),
        )

    def _filter_speed(self, arm_angle: float, number: int) -> None:
        if self._last_number is None:
            return
        steps = (number - self._last_number) % 2**32
        if steps:
            difference = (arm_angle - self._arm_angle) / (steps * self._dt)
            share = 1.0 - exp(-self._decay * steps)
            self._arm_speed += share * (difference - self._arm_speed)
