"""The host's side of the serial protocol: sessions, and statistics of the line."""

from secrets import randbits
from time import monotonic

from furuta_hw.connection.rig_driver import LineStatistics
from furuta_hw.drivers.serial_protocol.ports import Port
from furuta_hw.errors import LineError
from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import FrameReader, SensorsFrame, WelcomeFrame, encode, is_newer
from furuta_hw.rigs.rig import Rig

# Time between two attempts to start a session [s].
RETRY_PERIOD = 0.1


class ProtocolHost:
    """Talks to one rig through ``port``.

    A session starts with Hello and has a random number, so that frames of an earlier session that
    are still in a buffer are recognised and ignored.
    """

    def __init__(self, port: Port, rig: Rig) -> None:
        self._port = port
        self._rig = rig
        self._reader = FrameReader()
        self._welcome: WelcomeFrame | None = None
        self._discarded = 0
        self.session = 0
        self.sample = 0  # the newest one received
        self.received = self.lost = self.repeated = self.other_sessions = 0
        self.discarded_by_rig = 0

    def statistics(self) -> LineStatistics:
        """Return the frames counted so far."""
        return LineStatistics(
            self.lost,
            self._reader.corrupt,
            self.repeated,
            self.other_sessions,
            self.discarded_by_rig,
        )

    def start_session(self) -> None:
        """Ask the rig for a new session."""
        self.session = randbits(16)
        self.sample = self._discarded = 0
        self._welcome = None
        rig = self._rig
        hello = frames.HelloFrame(frames.VERSION, self.session, rig.period_us, rig.watchdog_samples)
        # The leading zero ends a frame that an earlier host may have left incomplete.
        self._port.write(b"\0" + encode(hello))

    def connect(self, timeout: float) -> None:
        """Ask for a session until the rig answers.

        Raises :class:`LineError` if it does not, or has another version, period or watchdog.
        """
        end = monotonic() + timeout
        while monotonic() < end:
            self.start_session()
            attempt_end = monotonic() + RETRY_PERIOD
            while monotonic() < attempt_end:
                self.receive(self._port.read())
                if self._session_accepted():
                    return
        raise LineError(
            f"no answer within {timeout:g} s: no rig, a different baud rate, or no power"
        )

    def _session_accepted(self) -> bool:
        """Whether the rig has accepted the session. Raises :class:`LineError` on a mismatch."""
        welcome, rig = self._welcome, self._rig
        if welcome is None:
            return False
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
        return True

    def receive(self, data: bytes) -> list[SensorsFrame]:
        """Return the samples that ``data`` completes, in order, each once."""
        samples = []
        for frame in self._reader.feed(data):
            if getattr(frame, "session", None) != self.session:
                self.other_sessions += 1
            elif isinstance(frame, WelcomeFrame):
                self._welcome = frame
            elif isinstance(frame, SensorsFrame) and self._welcome and self._count(frame):
                samples.append(frame)
        return samples

    def _count(self, frame: SensorsFrame) -> bool:
        """Update the statistics; False for a sample that was received before."""
        if not is_newer(frame.sample, self.sample):
            self.repeated += 1
            return False
        if self.received:
            self.lost += (frame.sample - self.sample - 1) % 2**32
        self.received += 1
        self.sample = frame.sample
        self.discarded_by_rig += (frame.discarded - self._discarded) % 2**16
        self._discarded = frame.discarded
        return True

    def arm(self) -> None:
        """Arm the rig."""
        self._port.write(encode(frames.ArmFrame(self.session, self.sample)))

    def drive(self, code: int) -> None:
        """Send the DA code in answer to the newest sample."""
        self._port.write(encode(frames.DriveFrame(self.session, self.sample, code)))

    def stop(self) -> None:
        """Disarm the rig and set it to 0 V."""
        self._port.write(encode(frames.StopFrame(self.session)))
