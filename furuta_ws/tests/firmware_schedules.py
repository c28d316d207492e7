"""Random schedules of frames and samples for firmware, and what the reference does with them."""

from typing import Any, NamedTuple
from zlib import crc32

from hypothesis import strategies as st

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

CODES = ((-2048, 2047, 0), (-32768, 32767, 0), (0, 4095, 2048), (-100, 50, -7))
PERIODS = (0, 1, 1000, 2**16, 2**32 - 1)
WATCHDOGS = (0, 1, 2, 3, 5, 50, 65535)


class Step(NamedTuple):
    """State after an operation, and what a sample sent to the host since the one before."""

    state: State
    out: bytes | None = None


class Schedule:
    """A script for the emulated board, and the reference's steps."""

    def __init__(self, codes: tuple[int, int, int] = CODES[0]) -> None:
        self.script = POWER_ON.pack(b"b", *codes, *ANY_TIMING)
        self.firmware = Firmware(*codes)
        self.fault = False
        self._last = b"\0"
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

    # Operations that depend on the rig's state; OPERATIONS makes them at random.

    def add_sample(self, fault: bool, arm: int, speed: int, pendulum: int) -> None:
        """A sample with or without a fault of the rig."""
        self.fault = fault
        self.sample(arm, speed, pendulum)

    def jump(self, number: int, age: int) -> None:
        """Continue near a wrap-around, so long after the last answer."""
        self.set_numbers(number % 2**32, (number - age) % 2**32)

    def add_frame(self, kind: str, session: int, age: int, value: int) -> None:
        """Send a frame to this session, or to another one, that answers a sample of this age."""
        session = ((self.firmware.session or 0) + session) % 2**16
        sample = (self.firmware.number - age) % 2**32
        made = {
            "arm": frames.ArmFrame(session, sample),
            "drive": frames.DriveFrame(session, sample, min(max(value, -(2**15)), 2**15 - 1)),
            "stop": frames.StopFrame(session),
            "hello": frames.HelloFrame(
                frames.VERSION + (value % 9 == 0),
                session,
                PERIODS[value % len(PERIODS)],
                WATCHDOGS[value % len(WATCHDOGS)],
            ),
            "welcome": frames.WelcomeFrame(1, session, 1000, 5),
            "sensors": frames.SensorsFrame(session, 1, 0, 1, 0, 0, 0, 0, 0),
        }
        self._last = encode(made[kind])
        self.receive(self._last)

    def repeat(self, at: int, new: bytes, removed: int) -> None:
        """Send the last frame again, changed in one place."""
        self.receive(self._last[:at] + new + self._last[at + removed :])

    def other_length(self, kind: int, body: bytes) -> None:
        """Send a frame with a right CRC, whose type has another length."""
        payload = bytes((kind,)) + (self.firmware.session or 0).to_bytes(2, "little") + body
        self.receive(stuff(payload + crc32(payload).to_bytes(4, "little")) + b"\0")


def integers(bits: int) -> st.SearchStrategy[int]:
    """Signed integers of so many bits."""
    return st.integers(-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


# What a host sends that drives the rig, and any other frame.
ANSWER = st.tuples(
    *(st.just("add_frame"), st.sampled_from(("arm", "drive", "drive")), st.just(0)),
    *(st.sampled_from((0, 0, 1)), st.integers(-60, 60)),
)
AGES = st.integers(-1, 6) | st.sampled_from((49, 50, 2**31 - 1, 2**31)) | integers(32)
KINDS = st.sampled_from(("arm", "drive", "drive", "stop", "hello", "welcome", "sensors"))
ANY_FRAME = st.tuples(
    *(st.just("add_frame"), KINDS, st.sampled_from((0, 0, 0, 1))),
    *(AGES, st.integers(-120, 120) | integers(17)),
)
FAULTS = st.sampled_from((False, False, False, True))
ANY_SAMPLE = st.tuples(st.just("add_sample"), FAULTS, integers(32), integers(16), integers(32))
BYTES = st.binary(max_size=4)
OPERATIONS = st.one_of(
    *(ANSWER, ANSWER, ANY_FRAME, ANY_FRAME, ANY_SAMPLE, ANY_SAMPLE),
    st.tuples(st.just("repeat"), st.integers(0, 20), BYTES, st.integers(0, 4)),
    st.tuples(st.just("jump"), st.sampled_from((5, 2**31 + 4, 2**32 - 3)), AGES),
    st.tuples(st.just("other_length"), st.integers(0, 255), st.binary(max_size=57)),
    st.tuples(st.just("receive"), st.binary(max_size=90)),
)


def random_schedules() -> st.SearchStrategy[Any]:
    """Codes, watchdog and operations of a schedule."""
    return st.tuples(
        st.sampled_from(CODES), st.sampled_from(WATCHDOGS[2:]), st.lists(OPERATIONS, min_size=20)
    )


def schedule_of(codes: tuple[int, int, int], watchdog: int, operations: list[Any]) -> Schedule:
    """The schedule with these operations in a session that has begun."""
    schedule = Schedule(codes)
    schedule.start_session(77, watchdog)
    for name, *arguments in operations:
        getattr(schedule, name)(*arguments)
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
