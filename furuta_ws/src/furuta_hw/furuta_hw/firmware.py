"""What a rig's firmware does, as a core without clock or line: the reference for any board."""

from __future__ import annotations

from furuta_hw import frames
from furuta_hw.frames import ARMED, FAULT, WATCHDOG, FrameReader, Message, encode, newer


class Firmware:
    """Obeys the host, and nobody when the host is silent.

    ``receive`` takes bytes as they come; ``sample`` is called by a timer every period, reads the
    sensors and says what goes out. Between samples the drive holds ``code``.
    """

    def __init__(self, low: int, high: int, zero: int) -> None:
        self._low, self._high, self._zero = low, high, zero
        self._reader = FrameReader()
        self._outbox = b""
        self._status = 0
        self._foreign = 0
        self.session: int | None = None  # None: no host, no stream
        self.period_us = 1000
        self.watchdog = 0
        self.number = 0
        self.answered = 0
        self.code = zero
        self.fault = False
        self.driven = 0  # drive frames obeyed

    @property
    def armed(self) -> bool:
        """Whether drive frames are obeyed."""
        return bool(self._status & ARMED)

    @property
    def tripped(self) -> bool:
        """Whether the watchdog has stopped the rig since it was last armed."""
        return bool(self._status & WATCHDOG)

    @property
    def discarded(self) -> int:
        """Frames thrown away since the session began: corrupt, foreign, stale or repeated."""
        return self._reader.corrupt + self._foreign

    def reboot(self) -> None:
        """As after power-on: no session, 0 V."""
        self._disarm()
        self.session, self._status = None, 0

    def receive(self, data: bytes) -> None:
        """Take bytes from the host."""
        for message in self._reader.feed(data):
            if not self._obey(message):
                self._foreign += 1

    def sample(self, arm: int, speed: int, pendulum: int) -> bytes:
        """One sample with these codes: watchdog, then what goes out to the host."""
        self.number = (self.number + 1) % 2**32
        applied = self.code
        self._watch()
        out, self._outbox = self._outbox, b""
        if self.session is None:
            return out
        return out + encode(
            frames.Sensors(
                self.session,
                self.number,
                self._status,
                self.answered,
                self.discarded % 2**16,
                arm,
                speed,
                pendulum,
                applied,
            )
        )

    def _watch(self) -> None:
        if self.armed and (self.number - self.answered) % 2**32 >= self.watchdog:
            self._disarm()
            self._status |= WATCHDOG
        self._status &= ~FAULT
        if self.fault:
            self._disarm()
            self._status |= FAULT

    def _disarm(self) -> None:
        self.code = self._zero
        self._status &= ~ARMED

    def _obey(self, message: Message) -> bool:
        """Do what the message says; False if it is not for now."""
        if isinstance(message, frames.Hello):
            return self._begin(message)
        if self.session is None or message.session != self.session:
            return False
        if isinstance(message, frames.Stop):
            self._disarm()
            return True
        if isinstance(message, frames.Arm):
            return self._arm(message)
        return isinstance(message, frames.Drive) and self._drive(message)

    def _arm(self, arm: frames.Arm) -> bool:
        if self.fault or not self._fresh(arm.sample):
            return False
        self._status = ARMED
        self.answered, self.code = arm.sample, self._zero
        return True

    def _drive(self, drive: frames.Drive) -> bool:
        # The newest sample may be answered again, which feeds no watchdog; an older one not.
        fresh = self._fresh(drive.sample) and not newer(self.answered, drive.sample)
        if not (self.armed and fresh and self._low <= drive.code <= self._high):
            return False
        self.answered, self.code = drive.sample, drive.code
        self.driven += 1
        return True

    def _fresh(self, sample: int) -> bool:
        """Whether a frame answers a sample within the watchdog's time."""
        return (self.number - sample) % 2**32 < self.watchdog

    def _begin(self, hello: frames.Hello) -> bool:
        self._disarm()
        self._status = 0
        self._reader.corrupt = self._foreign = 0
        self.number = self.answered = 0
        same = hello.version == frames.VERSION
        self.session = hello.session if same else None
        self.period_us, self.watchdog = hello.period_us, hello.watchdog
        self._outbox += encode(
            frames.Welcome(frames.VERSION, hello.session, self.period_us, self.watchdog)
        )
        return True
