"""The host's side of the protocol: handshake, sessions, and what went wrong on the line."""

from __future__ import annotations

from secrets import randbits
from time import monotonic

from furuta_hw import frames
from furuta_hw.backend import Backend
from furuta_hw.errors import LineError
from furuta_hw.frames import FrameReader, Sensors, Welcome, encode, newer
from furuta_hw.rig import Rig

# Time between two attempts to be heard [s].
REPEAT = 0.1


class Host:
    """Talks to one rig through ``backend``.

    A session begins with Hello and bears a random number, so that what is left over of an earlier
    one, in whatever buffer, is not taken for a part of this.
    """

    def __init__(self, backend: Backend, rig: Rig) -> None:
        self._backend = backend
        self._rig = rig
        self._reader = FrameReader()
        self._welcome: Welcome | None = None
        self._discarded = 0
        self.session = 0
        self.sample = 0  # the newest one received
        self.received = self.lost = self.repeated = self.foreign = self.refused = 0

    @property
    def corrupt(self) -> int:
        """Frames from the rig that were none."""
        return self._reader.corrupt

    @property
    def bad(self) -> int:
        """Frames lost or corrupt on either way since the session began."""
        return self.lost + self.corrupt + self.refused

    def hello(self) -> None:
        """Ask for a session."""
        self.session = randbits(16)
        self.sample = self._discarded = 0
        self._welcome = None
        rig = self._rig
        hello = frames.Hello(frames.VERSION, self.session, rig.period_us, rig.watchdog_samples)
        # The closing zero of a frame that an earlier host left unfinished goes first.
        self._backend.write(b"\0" + encode(hello))

    def connect(self, timeout: float) -> None:
        """Ask until the rig answers. Raises :class:`LineError` if it does not, or differs."""
        end = monotonic() + timeout
        while monotonic() < end:
            self.hello()
            attempt = monotonic() + REPEAT
            while monotonic() < attempt:
                self.receive(self._backend.read())
                if self.welcomed:
                    return
        raise LineError(f"no answer within {timeout:g} s: no rig, another baud rate, or no power")

    @property
    def welcomed(self) -> bool:
        """Whether the rig has agreed to this session. Raises :class:`LineError` if it differs."""
        welcome, rig = self._welcome, self._rig
        if welcome is None:
            return False
        if welcome.version != frames.VERSION:
            raise LineError(
                f"the rig speaks version {welcome.version} of the protocol, this is version "
                f"{frames.VERSION}"
            )
        if (welcome.period_us, welcome.watchdog) != (rig.period_us, rig.watchdog_samples):
            raise LineError(
                f"the rig offers {welcome.period_us} µs and a watchdog of {welcome.watchdog} "
                f"samples, the rig file wants {rig.period_us} µs and {rig.watchdog_samples}"
            )
        return True

    def receive(self, data: bytes) -> list[Sensors]:
        """The samples that ``data`` completes, in order, each once."""
        samples = []
        for message in self._reader.feed(data):
            if getattr(message, "session", None) != self.session:
                self.foreign += 1
            elif isinstance(message, Welcome):
                self._welcome = message
            elif isinstance(message, Sensors) and self._welcome and self._count(message):
                samples.append(message)
        return samples

    def _count(self, sensors: Sensors) -> bool:
        """Keep the books; False for a sample that came before."""
        if not newer(sensors.sample, self.sample):
            self.repeated += 1
            return False
        if self.received:
            self.lost += (sensors.sample - self.sample - 1) % 2**32
        self.received += 1
        self.sample = sensors.sample
        self.refused += (sensors.discarded - self._discarded) % 2**16
        self._discarded = sensors.discarded
        return True

    def arm(self) -> None:
        """Have the rig obey."""
        self._backend.write(encode(frames.Arm(self.session, self.sample)))

    def drive(self, code: int) -> None:
        """The DA code that answers the newest sample."""
        self._backend.write(encode(frames.Drive(self.session, self.sample, code)))

    def stop(self) -> None:
        """0 V."""
        self._backend.write(encode(frames.Stop(self.session)))
