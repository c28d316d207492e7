"""The wire: message ↔ frame, byte by byte. docs/hardware.md holds the same as tables.

A frame is COBS(payload) and a zero byte; a payload is the message's type (one byte), its fields
(little-endian) and the CRC-32 of both (IEEE 802.3, as ``zlib.crc32``). COBS leaves no zero byte
inside a frame, so a reader that comes late, or lost bytes, is back in step at the next zero.
"""

from __future__ import annotations

import struct
from typing import NamedTuple
from zlib import crc32

VERSION = 1
# Longer than any frame; COBS needs no second length byte below 254.
LONGEST_FRAME = 64


class Hello(NamedTuple):
    """Host → rig: begin a session. The rig goes to 0 V, disarmed, sample counter at 0."""

    version: int
    session: int
    period_us: int
    watchdog: int


class Drive(NamedTuple):
    """Host → rig: the DA code that answers ``sample``."""

    session: int
    sample: int
    code: int


class Arm(NamedTuple):
    """Host → rig: obey drive frames from now on; ``sample`` is the newest one seen."""

    session: int
    sample: int


class Stop(NamedTuple):
    """Host → rig: 0 V, disarmed."""

    session: int


class Welcome(NamedTuple):
    """Rig → host: the answer to Hello, with what the rig will do."""

    version: int
    session: int
    period_us: int
    watchdog: int


class Sensors(NamedTuple):
    """Rig → host, every sample: what the rig reads, and what it does.

    ``status`` is a sum of the bits below, ``answered`` the sample of the newest drive frame
    obeyed, ``discarded`` the frames thrown away since Hello (mod 65536), ``drive`` the code in
    force up to this sample.
    """

    session: int
    sample: int
    status: int
    answered: int
    discarded: int
    arm: int
    speed: int
    pendulum: int
    drive: int


# Bits of the status.
ARMED, WATCHDOG, FAULT = 1, 2, 4

Message = Hello | Drive | Arm | Stop | Welcome | Sensors

FORMATS: dict[type[Message], tuple[int, struct.Struct]] = {
    Hello: (0x01, struct.Struct("<BHIH")),
    Drive: (0x02, struct.Struct("<HIh")),
    Arm: (0x03, struct.Struct("<HI")),
    Stop: (0x04, struct.Struct("<H")),
    Welcome: (0x81, struct.Struct("<BHIH")),
    Sensors: (0x82, struct.Struct("<HIBIHihih")),
}
_KINDS = {number: (kind, layout) for kind, (number, layout) in FORMATS.items()}
_CRC = struct.Struct("<I")


class FrameError(ValueError):
    """Bytes that are no frame of this protocol."""


def encode(message: Message) -> bytes:
    """The frame of a message, with its closing zero."""
    number, layout = FORMATS[type(message)]
    body = bytes((number,)) + layout.pack(*message)
    return stuff(body + _CRC.pack(crc32(body))) + b"\0"


def decode(frame: bytes) -> Message:
    """The message of a frame without its closing zero; raises :class:`FrameError`."""
    payload = unstuff(frame)
    body, crc = payload[:-4], payload[-4:]
    if len(body) < 1 or _CRC.pack(crc32(body)) != crc:
        raise FrameError("wrong CRC")
    if body[0] not in _KINDS:
        raise FrameError(f"unknown type {body[0]}")
    kind, layout = _KINDS[body[0]]
    if len(body) != 1 + layout.size:
        raise FrameError(f"{kind.__name__} of {len(body)} bytes")
    return kind(*layout.unpack_from(body, 1))


def stuff(payload: bytes) -> bytes:
    """COBS of a payload of less than 254 bytes: each run between zeros led by its length + 1."""
    return b"".join(bytes((len(run) + 1,)) + run for run in payload.split(b"\0"))


def unstuff(frame: bytes) -> bytes:
    """The inverse of :func:`stuff`; raises :class:`FrameError`."""
    if not 0 < len(frame) <= LONGEST_FRAME or 0 in frame:
        raise FrameError(f"frame of {len(frame)} bytes")
    runs = []
    at = 0
    while at < len(frame):
        end = at + frame[at]
        if end > len(frame):
            raise FrameError("run beyond the frame's end")
        runs.append(frame[at + 1 : end])
        at = end
    return b"\0".join(runs)


class FrameReader:
    """Cuts a stream of bytes into messages; what is none is counted in ``corrupt``."""

    def __init__(self) -> None:
        self.corrupt = 0
        self._rest = b""
        self._overlong = False

    def feed(self, data: bytes) -> list[Message]:
        """The messages that ``data`` completes."""
        *frames, rest = (self._rest + data).split(b"\0")
        messages = []
        for frame in frames:
            if self._overlong:
                self._overlong = False  # the end of what was thrown away
            elif frame:
                try:
                    messages.append(decode(frame))
                except FrameError:
                    self.corrupt += 1
        if len(rest) > LONGEST_FRAME:
            self.corrupt += not self._overlong
            self._overlong, rest = True, b""
        self._rest = rest
        return messages


def newer(sample: int, than: int) -> bool:
    """Whether a 32-bit sample number comes after another, across the wrap-around."""
    return 0 < (sample - than) % 2**32 < 2**31
