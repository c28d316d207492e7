"""Random schedules of frames and samples for firmware, and what the reference does with them."""

from random import Random
from typing import NamedTuple
from zlib import crc32

from furuta_hw.emulator.compiled_firmware import (
    ANY_TIMING,
    POWER_ON,
    RECEIVE,
    SAMPLE,
    State,
    parse_log,
)
from furuta_hw.emulator.firmware import Firmware
from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import encode, stuff

# Sample numbers near these are where arithmetic on 32 bits could go wrong.
WRAP_AROUNDS = (0, 2**31, 2**32)
CODES = ((-2048, 2047, 0), (-32768, 32767, 0), (0, 4095, 2048), (-100, 50, -7))
PERIODS = (0, 1, 1000, 2**16, 2**32 - 1)
WATCHDOGS = (0, 1, 2, 3, 5, 50, 65535)


class Step(NamedTuple):
    """State after an operation, and what a sample sent to the host since the one before."""

    state: State
    out: bytes | None = None


class Schedule:
    """A script for the emulated board, and the reference's steps."""

    def __init__(self, random: Random, codes: tuple[int, int, int] = CODES[0]) -> None:
        self._random = random
        self.script = POWER_ON.pack(b"b", *codes, *ANY_TIMING)
        self.low, self.high, _ = codes
        self.firmware = Firmware(*codes)
        self.fault = False
        self.frames = 0
        self._sent: list[bytes] = []
        self.steps = [Step(self._state())]

    def receive(self, data: bytes) -> None:
        """Send bytes to the rig."""
        self.script += RECEIVE.pack(b"r", self.fault, len(data)) + data
        self.firmware.fault = self.fault
        self.firmware.receive(data)
        self.steps.append(Step(self._state()))

    def sample(self, arm: int = 0, speed: int = 0, pendulum: int = 0) -> None:
        """Take a sample."""
        self.script += SAMPLE.pack(b"s", self.fault, arm, speed, pendulum)
        self.firmware.fault = self.fault
        out = self.firmware.sample(arm, speed, pendulum)
        self.steps.append(Step(self._state(), out))

    def set_numbers(self, number: int, answered: int) -> None:
        """Let the sample numbers continue from these."""
        self.script += b"n" + number.to_bytes(4, "little") + answered.to_bytes(4, "little")
        self.firmware.number, self.firmware.answered = number, answered
        self.steps.append(Step(self._state()))

    def send(self, *sent: frames.Frame) -> None:
        """Send frames, undamaged."""
        self.receive(b"".join(map(encode, sent)))

    def start_session(self, session: int = 77, watchdog: int = 5) -> None:
        """Send Hello, take a sample, and arm."""
        self.send(frames.HelloFrame(frames.VERSION, session, 1000, watchdog))
        self.sample()
        self.send(frames.ArmFrame(session, self.firmware.number))

    def _state(self) -> State:
        firmware = self.firmware
        return State(
            *(firmware.number, firmware.answered, firmware.driven, firmware.period_us),
            *(firmware.session or 0, firmware.watchdog, firmware.discarded % 2**16),
            *(firmware.code, firmware.code, firmware._status, firmware.session is not None),
        )

    def add_random(self, operations: int) -> None:
        """Add random operations: samples, frames of every kind, damaged frames, jumps."""
        for _ in range(operations):
            kind = self._random.random()
            if kind < 0.4:
                self._add_sample()
            elif kind < 0.41:
                self._jump()
            else:
                self._add_bytes()

    def _add_sample(self) -> None:
        random = self._random
        self.fault = random.random() < 0.02
        extreme = random.random() < 0.1
        arm = random.choice((-(2**31), 2**31 - 1, -1)) if extreme else random.randrange(-999, 999)
        speed = random.choice((-(2**15), 2**15 - 1)) if extreme else random.randrange(-99, 99)
        self.sample(arm, speed, random.randrange(-(2**31), 2**31))

    def _jump(self) -> None:
        random = self._random
        number = (random.choice(WRAP_AROUNDS) + random.randrange(-5, 5)) % 2**32
        age = random.choice((0, 1, 2, 2**31, random.randrange(2**32)))
        self.set_numbers(number, (number - age) % 2**32)

    def _add_bytes(self) -> None:
        random = self._random
        data = b"".join(self._damaged(self._frame()) for _ in range(random.choice((1, 1, 1, 2, 4))))
        cut = random.randrange(len(data) + 1) if random.random() < 0.2 else len(data)
        self.receive(data[:cut])
        if cut < len(data):
            if random.random() < 0.5:
                self._add_sample()
            self.receive(data[cut:])

    def _frame(self) -> bytes:
        random = self._random
        self.frames += 1
        if self._sent and random.random() < 0.1:
            return random.choice(self._sent[-20:])  # repeated or late
        if random.random() < 0.03:
            return self._of_another_length()
        frame = encode(self._new_frame())
        self._sent.append(frame)
        return frame

    def _new_frame(self) -> frames.Frame:
        random = self._random
        session = self.firmware.session or 0
        if random.random() < 0.05:
            session = random.randrange(2**16)
        sample = (self.firmware.number - self._age()) % 2**32
        kind = random.random()
        if kind < 0.65:
            return frames.DriveFrame(session, sample, self._code())
        if kind < 0.9:
            return frames.ArmFrame(session, sample)
        if kind < 0.93:
            return frames.StopFrame(session)
        if kind < 0.97:
            return self._hello()
        return random.choice((frames.WelcomeFrame(1, session, 1000, 5), sensors(session)))

    def _of_another_length(self) -> bytes:
        """A frame with a right CRC, whose type has another length."""
        random = self._random
        body = bytes((random.choice((1, 2, 3, 4, random.randrange(256))),))
        body += (self.firmware.session or 0).to_bytes(2, "little")
        body += self.firmware.number.to_bytes(4, "little") + bytes(random.randrange(57))
        body = body[: random.randrange(len(body) + 1)] if random.random() < 0.5 else body
        return stuff(body + crc32(body).to_bytes(4, "little")) + b"\0"

    def _age(self) -> int:
        random, watchdog = self._random, self.firmware.watchdog
        if random.random() < 0.7:
            return random.choice((0, 0, 0, 1))
        return random.choice((-1, 2, watchdog - 1, watchdog, watchdog + 1, 2**31, 2**31 - 1))

    def _code(self) -> int:
        random = self._random
        code = random.randrange(self.low, self.high + 1)
        edges = (self.low, self.high, self.low - 1, self.high + 1, -(2**15), 2**15 - 1)
        if random.random() < 0.2:
            code = random.choice(edges)
        return min(max(code, -(2**15)), 2**15 - 1)

    def _hello(self) -> frames.HelloFrame:
        random = self._random
        version = frames.VERSION if random.random() < 0.9 else random.randrange(256)
        session = random.randrange(2**16)
        return frames.HelloFrame(version, session, random.choice(PERIODS), random.choice(WATCHDOGS))

    def _damaged(self, frame: bytes) -> bytes:
        random = self._random
        at = random.randrange(len(frame))
        byte = random.choice((random.randrange(256), (frame[at] + 1) % 256))
        damages = {
            frame: 70,
            frame[:at] + bytes((byte,)) + frame[at + 1 :]: 10,
            frame[at:]: 5,
            frame[:at] + random.randbytes(random.randrange(1, 4)) + frame[at:]: 5,
            frame[:-1]: 3,  # the next frame is joined to it
            frame + b"\0\0": 3,
            random.randbytes(random.randrange(90)) + frame: 2,
            b"\1" * random.randrange(60, 70) + random.choice((b"\0", b"")) + frame: 2,
        }
        (damaged,) = random.choices([*damages], [*damages.values()])
        return damaged


def sensors(session: int) -> frames.SensorsFrame:
    """A frame that a host never sends."""
    return frames.SensorsFrame(session, 1, 0, 1, 0, 0, 0, 0, 0)


def random_schedule(seed: int, operations: int) -> Schedule:
    """Make a schedule from a seed."""
    random = Random(seed)
    schedule = Schedule(random, random.choice(CODES))
    schedule.start_session(random.randrange(2**16), random.choice(WATCHDOGS[2:]))
    schedule.add_random(operations)
    schedule.sample()
    return schedule


def assert_same(schedule: Schedule, log: bytes) -> None:
    """Compare the log of a replay with the reference.

    A board answers Hello at once, the reference with the next sample. So bytes are compared at
    samples, and states after every operation.
    """
    sent = b""
    for (out, state), expected in zip(parse_log(log), schedule.steps, strict=True):
        assert without_old_session(state) == expected.state
        sent += out
        if expected.out is not None:
            assert sent == expected.out
            sent = b""
    assert sent == b""


def without_old_session(state: State) -> State:
    """The state with session 0 if there is none: its number does not matter then."""
    return state if state.in_session else state._replace(session=0)
