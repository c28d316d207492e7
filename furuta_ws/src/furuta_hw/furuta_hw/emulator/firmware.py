"""Reference firmware of a rig, without clock or line. docs/hardware.md states the same rules."""

from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import (
    ARMED,
    FAULT,
    WATCHDOG,
    Frame,
    FrameReader,
    SensorsFrame,
    encode,
    is_newer,
)


class Firmware:
    """Executes the host's frames, and goes to 0 V when the host is silent.

    Call ``receive`` with bytes when they arrive, and ``sample`` from a timer every period with the
    sensors' codes. Between samples the drive holds ``code``.
    """

    def __init__(self, low: int, high: int, zero: int) -> None:
        self._low, self._high, self._zero = low, high, zero
        self.fault = False
        self.driven = 0  # Drive frames applied, also before a reboot
        self.reboot()

    @property
    def armed(self) -> bool:
        """Whether Drive frames are applied."""
        return bool(self._status & ARMED)

    @property
    def tripped(self) -> bool:
        """Whether the watchdog has stopped the rig since it was last armed."""
        return bool(self._status & WATCHDOG)

    @property
    def discarded(self) -> int:
        """Frames discarded since the session started: corrupt, foreign, stale or repeated."""
        return self._reader.corrupt + self._rejected

    def reboot(self) -> None:
        """Return to the state after power-on: no session, 0 V."""
        self._reader = FrameReader()
        self._outbox = b""
        self._status = 0
        self._rejected = 0
        self.session: int | None = None  # without a session the rig sends no samples
        self.period_us = 1000
        self.watchdog = 0
        self.number = 0
        self.answered = 0
        self.code = self._zero

    def receive(self, data: bytes) -> None:
        """Execute the frames that these bytes complete."""
        for frame in self._reader.read(data):
            if not self._execute(frame):
                self._rejected += 1

    def sample(self, arm: int, speed: int, pendulum: int) -> bytes:
        """Take one sample with these codes; returns the bytes for the host."""
        self.number = (self.number + 1) % 2**32
        applied = self.code
        self._check_watchdog_and_fault()
        out, self._outbox = self._outbox, b""
        if self.session is None:
            return out
        discarded = self.discarded % 2**16
        return out + encode(
            SensorsFrame(
                *(self.session, self.number, self._status, self.answered, discarded),
                *(arm, speed, pendulum, applied),
            )
        )

    def _check_watchdog_and_fault(self) -> None:
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

    def _execute(self, frame: Frame) -> bool:
        """Execute a frame; False if it is rejected."""
        if isinstance(frame, frames.HelloFrame):
            return self._start_session(frame)
        if self.session is None or frame.session != self.session:
            return False
        if isinstance(frame, frames.StopFrame):
            self._disarm()
            return True
        if isinstance(frame, frames.ArmFrame):
            return self._arm(frame)
        return isinstance(frame, frames.DriveFrame) and self._drive(frame)

    def _arm(self, frame: frames.ArmFrame) -> bool:
        if self.fault or not self._is_fresh(frame.sample):
            return False
        self._status = ARMED
        self.answered, self.code = frame.sample, self._zero
        return True

    def _drive(self, frame: frames.DriveFrame) -> bool:
        # A second answer to the newest sample is accepted, but does not feed the watchdog.
        accepted = self._is_fresh(frame.sample) and not is_newer(self.answered, frame.sample)
        if not (self.armed and accepted and self._low <= frame.code <= self._high):
            return False
        self.answered, self.code = frame.sample, frame.code
        self.driven += 1
        return True

    def _is_fresh(self, sample: int) -> bool:
        """Whether a frame answers a sample within the watchdog's time."""
        return (self.number - sample) % 2**32 < self.watchdog

    def _start_session(self, hello: frames.HelloFrame) -> bool:
        self._disarm()
        self._status = 0
        self._reader.corrupt = self._rejected = 0
        self.number = self.answered = 0
        same_version = hello.version == frames.VERSION
        self.session = hello.session if same_version else None
        self.period_us, self.watchdog = hello.period_us, hello.watchdog
        self._outbox += encode(
            frames.WelcomeFrame(frames.VERSION, hello.session, self.period_us, self.watchdog)
        )
        return True
