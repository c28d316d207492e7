"""The C firmware compiled for this computer."""

import ctypes
import struct
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from furuta_hw.emulator.firmware import Firmware
from furuta_hw.emulator.firmware_compiler import (
    compile_firmware,
    emulated_sources,
    on_board_options,
)

# The operations and the log of firmware/boards/emulated/emulated.c.
POWER_ON = struct.Struct("<chhhIIH")
RECEIVE = struct.Struct("<cBH")
SAMPLE = struct.Struct("<cBihi")
STATE = struct.Struct("<IIIIHHHhhBB")
LENGTH = struct.Struct("<H")
# Like the reference, the emulated board supports every period [µs] and watchdog [samples].
ANY_TIMING = 0, 0xFFFFFFFF, 0xFFFF
# The log of an operation is at most so many times as long.
LOG_FACTOR = 64
LONGEST_RECEIVE = 0xFFFF


class State(NamedTuple):
    """State of the firmware after an operation; ``drive`` is what the board last received."""

    number: int
    answered: int
    driven: int
    period_us: int
    session: int
    watchdog: int
    discarded: int
    code: int
    drive: int
    status: int
    in_session: int


class CompiledFirmware(Firmware):
    """The same as the reference firmware, whose rules the C core executes.

    Each object loads a copy of its own, because the firmware keeps its state in static memory.
    With ``loop``, the folder of an exported loop, that loop runs on the board.
    """

    def __init__(self, low: int, high: int, zero: int, loop: Path | None = None) -> None:
        self._replay = load_replay(*(on_board_options(loop) if loop else ()))
        self._codes = (low, high, zero)
        self.fault = False
        self._driven_before = 0  # a reboot
        self._outbox = b""
        self._power_on()

    def reboot(self) -> None:
        """Return to the state after power-on: no session, 0 V."""
        self._driven_before = self.driven
        self._power_on()

    def receive(self, data: bytes) -> None:
        """Execute the frames that these bytes complete."""
        for at in range(0, len(data), LONGEST_RECEIVE):
            part = data[at : at + LONGEST_RECEIVE]
            self._outbox += self._run(RECEIVE.pack(b"r", self.fault, len(part)) + part)

    def sample(self, arm: int, speed: int, pendulum: int) -> bytes:
        """Take one sample with these codes; returns the bytes for the host."""
        out, self._outbox = self._outbox, b""
        return out + self._run(SAMPLE.pack(b"s", self.fault, arm, speed, pendulum))

    def _power_on(self) -> None:
        self._outbox = self._run(POWER_ON.pack(b"b", *self._codes, *ANY_TIMING))

    def _run(self, operation: bytes) -> bytes:
        ((out, state),) = parse_log(self._replay(operation))
        self.number, self.answered = state.number, state.answered
        self.period_us, self.watchdog = state.period_us, state.watchdog
        self.session = state.session if state.in_session else None
        self.code, self._status, self._discarded = state.drive, state.status, state.discarded
        self.driven = self._driven_before + state.driven
        return out

    @property
    def discarded(self) -> int:
        """Frames discarded since the session started."""
        return self._discarded


def load_replay(*options: str | Path) -> Callable[[bytes], bytes]:
    """Compile the emulated board and load it; returns a function from script to log."""
    with tempfile.TemporaryDirectory() as directory:
        library = Path(directory) / "firmware.so"
        compile_firmware(emulated_sources(), library, "-shared", "-fPIC", *options)
        function = ctypes.CDLL(str(library)).emulated_replay

    def replay(script: bytes) -> bytes:
        log = ctypes.create_string_buffer(LOG_FACTOR * len(script))
        size = function(script, ctypes.c_uint32(len(script)), log)
        return ctypes.string_at(log, size)

    return replay


def parse_log(log: bytes) -> list[tuple[bytes, State]]:
    """Split the log of a replay into what each operation sent, and the state after it."""
    entries = []
    at = 0
    while at < len(log):
        (length,) = LENGTH.unpack_from(log, at)
        end = at + LENGTH.size + length
        entries.append((log[at + LENGTH.size : end], State(*STATE.unpack_from(log, end))))
        at = end + STATE.size
    return entries
