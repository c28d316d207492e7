"""Frames of the serial protocol and their encoding; docs/hardware.md has the same as tables.

On the line a frame is COBS(payload) and a zero byte. The payload is the frame's type (one byte),
its fields (little-endian) and the CRC-32 of both (IEEE 802.3, as ``zlib.crc32``). COBS leaves no
zero byte inside a frame, so a reader that lost bytes is synchronised again at the next zero.
"""

import struct
from collections.abc import Iterator
from typing import NamedTuple
from zlib import crc32

VERSION = 1
# No frame is longer [bytes]; below 254 bytes COBS needs no second length byte.
LONGEST_FRAME = 64


class HelloFrame(NamedTuple):
    """Host → rig: start a session. The rig is disarmed at 0 V and counts samples from 0."""

    version: int
    session: int
    period_us: int
    watchdog: int


class DriveFrame(NamedTuple):
    """Host → rig: the DA code that answers ``sample``."""

    session: int
    sample: int
    code: int


class ArmFrame(NamedTuple):
    """Host → rig: apply the Drive frames that follow; ``sample`` is the newest one received."""

    session: int
    sample: int


class StopFrame(NamedTuple):
    """Host → rig: go to 0 V and disarm."""

    session: int


class WelcomeFrame(NamedTuple):
    """Rig → host: the answer to Hello, with the period and watchdog that the rig will use."""

    version: int
    session: int
    period_us: int
    watchdog: int


class SensorsFrame(NamedTuple):
    """Rig → host, every sample: sensor codes and state of the rig.

    ``status`` is a sum of the bits below, ``answered`` the sample of the newest Drive frame that
    was applied, ``discarded`` the number of frames discarded since Hello (mod 65536), ``drive``
    the DA code applied up to this sample.
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

Frame = HelloFrame | DriveFrame | ArmFrame | StopFrame | WelcomeFrame | SensorsFrame

FORMATS: dict[type[Frame], tuple[int, struct.Struct]] = {
    HelloFrame: (0x01, struct.Struct("<BHIH")),
    DriveFrame: (0x02, struct.Struct("<HIh")),
    ArmFrame: (0x03, struct.Struct("<HI")),
    StopFrame: (0x04, struct.Struct("<H")),
    WelcomeFrame: (0x81, struct.Struct("<BHIH")),
    SensorsFrame: (0x82, struct.Struct("<HIBIHihih")),
}
_TYPES = {number: (kind, layout) for kind, (number, layout) in FORMATS.items()}
_CRC = struct.Struct("<I")


class FrameError(ValueError):
    """Bytes that are not a frame of this protocol."""


def encode(frame: Frame) -> bytes:
    """Encode a frame, with its closing zero."""
    number, layout = FORMATS[type(frame)]
    body = bytes((number,)) + layout.pack(*frame)
    return stuff(body + _CRC.pack(crc32(body))) + b"\0"


def decode(data: bytes) -> Frame:
    """Decode a frame without its closing zero; raises :class:`FrameError`."""
    payload = unstuff(data)
    body, crc = payload[:-4], payload[-4:]
    if len(body) < 1 or _CRC.pack(crc32(body)) != crc:
        raise FrameError("wrong CRC")
    if body[0] not in _TYPES:
        raise FrameError(f"unknown type {body[0]}")
    kind, layout = _TYPES[body[0]]
    if len(body) != 1 + layout.size:
        raise FrameError(f"{kind.__name__} of {len(body)} bytes")
    return kind(*layout.unpack_from(body, 1))


def stuff(payload: bytes) -> bytes:
    """COBS of a payload of less than 254 bytes: length + 1 before each run between zeros."""
    return b"".join(bytes((len(run) + 1,)) + run for run in payload.split(b"\0"))


def unstuff(data: bytes) -> bytes:
    """The inverse of :func:`stuff`; raises :class:`FrameError`."""
    if not 0 < len(data) <= LONGEST_FRAME or 0 in data:
        raise FrameError(f"frame of {len(data)} bytes")
    runs = []
    at = 0
    while at < len(data):
        end = at + data[at]
        if end > len(data):
            raise FrameError("run beyond the frame's end")
        runs.append(data[at + 1 : end])
        at = end
    return b"\0".join(runs)


class FrameReader:
    """Splits a stream of bytes into frames, and counts invalid ones in ``corrupt``."""

    def __init__(self) -> None:
        self.corrupt = 0
        self._rest = b""
        self._overlong = False

    def read(self, data: bytes) -> Iterator[Frame]:
        """Yield the frames that ``data`` completes; ``corrupt`` counts up to the frame yielded."""
        *pieces, rest = (self._rest + data).split(b"\0")
        for piece in pieces:
            if self._overlong:
                self._overlong = False  # the end of the bytes that were discarded
            elif piece:
                try:
                    frame = decode(piece)
                except FrameError:
                    self.corrupt += 1
                else:
                    yield frame
        if len(rest) > LONGEST_FRAME:
            self.corrupt += not self._overlong
            self._overlong, rest = True, b""
        self._rest = rest


def is_newer(sample: int, than: int) -> bool:
    """Whether a 32-bit sample number comes after another, across the wrap-around."""
    return 0 < (sample - than) % 2**32 < 2**31
