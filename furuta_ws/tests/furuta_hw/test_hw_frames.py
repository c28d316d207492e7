"""Frames of the serial protocol: encoding, decoding and invalid bytes."""

import re
import struct
from pathlib import Path
from zlib import crc32

import numpy as np
import pytest
from cobs import cobs
from hypothesis import given, settings
from hypothesis import strategies as st

from furuta_hw.emulator.firmware import Firmware
from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import (
    FrameError,
    FrameReader,
    decode,
    encode,
    is_newer,
    stuff,
    unstuff,
)

PAGE = Path(__file__).resolve().parents[3] / "docs" / "hardware.md"
FRAMES = [
    frames.HelloFrame(1, 0x1234, 1000, 50),
    frames.DriveFrame(0x1234, 0xFFFFFFFF, -2048),
    frames.ArmFrame(0, 7),
    frames.StopFrame(0xFF00),
    frames.WelcomeFrame(1, 0x1234, 1000, 50),
    frames.SensorsFrame(0x1234, 100000, 3, 99999, 65535, -250, 2047, -2048, 0),
]


def documented_name(kind: type[frames.Frame]) -> str:
    """The name of a frame in docs/hardware.md."""
    return kind.__name__.removesuffix("Frame")


def valid(frame: bytes) -> bool:
    """Whether a frame's CRC is right, found without the code under test."""
    try:
        payload = cobs.decode(frame)
    except cobs.DecodeError:
        return False
    return len(payload) > 4 and struct.pack("<I", crc32(payload[:-4])) == payload[-4:]


@pytest.mark.parametrize("frame", FRAMES, ids=lambda each: type(each).__name__)
def test_encoded_frames_are_decoded(frame: frames.Frame) -> None:
    """Every frame survives encoding, which has one zero byte, at its end."""
    data = encode(frame)
    assert data.index(0) == len(data) - 1
    assert len(data) <= frames.LONGEST_FRAME
    assert decode(data[:-1]) == frame


@given(st.binary(max_size=frames.LONGEST_FRAME - 1))
def test_stuffing_is_cobs(payload: bytes) -> None:
    """The same bytes as an independent library, both ways."""
    assert stuff(payload) == cobs.encode(payload)
    assert unstuff(stuff(payload)) == payload


@given(st.binary(max_size=80))
def test_unstuffing_rejects_invalid_bytes(frame: bytes) -> None:
    """The same bytes are rejected, and the same result returned, as by an independent library."""
    try:
        expected = cobs.decode(frame) if 0 < len(frame) <= frames.LONGEST_FRAME else None
    except cobs.DecodeError:
        expected = None
    try:
        got = unstuff(frame)
    except FrameError:
        got = None
    assert got == expected


def test_test_vectors_of_the_documentation() -> None:
    """docs/hardware.md: each vector is a frame's text and its bytes."""
    rows = re.findall(r"^\| `(\w+\([^`]*\))` \| `([0-9a-f ]+)` \|$", PAGE.read_text(), re.M)
    assert len(rows) >= len(frames.FORMATS)
    for text, hexadecimal in rows:
        frame = eval(text, {documented_name(kind): kind for kind in frames.FORMATS})
        assert encode(frame) == bytes.fromhex(hexadecimal), text


def test_layouts_of_the_documentation() -> None:
    """docs/hardware.md: type number, fields in order, and size of each frame."""
    text = PAGE.read_text()
    kinds = {"B": "u8", "H": "u16", "h": "i16", "I": "u32", "i": "i32"}
    for kind, (number, layout) in frames.FORMATS.items():
        fields = ", ".join(
            f"{name} {kinds[code]}"
            for name, code in zip(kind._fields, layout.format.lstrip("<"), strict=True)
        )
        row = f"| `0x{number:02x}` {documented_name(kind)} | {fields} | {1 + layout.size + 4} |"
        assert row in text, row


def mutations(count: int) -> list[bytes]:
    """Random bytes, and valid frames changed, cut, joined, doubled; as streams with zeros."""
    random = np.random.default_rng(1)
    valid_frames = [encode(frame) for frame in FRAMES]
    made = []
    for number in range(count):
        frame = bytearray(valid_frames[number % len(valid_frames)])
        kind = number % 5
        if kind == 0:
            frame = bytearray(random.bytes(int(random.integers(0, 90))))
        elif kind == 1:
            frame[int(random.integers(len(frame)))] = int(random.integers(256))
        elif kind == 2:
            frame = frame[int(random.integers(len(frame))) :]
        elif kind == 3:
            at = int(random.integers(len(frame)))
            frame[at:at] = random.bytes(int(random.integers(1, 4)))
        else:
            frame = frame[:-1] + valid_frames[int(random.integers(len(valid_frames)))]
        made.append(bytes(frame))
    return made


def test_ten_thousand_bad_frames_at_the_host() -> None:
    """Nothing crashes, and exactly the frames with a correct CRC are decoded."""
    reader = FrameReader()
    for stream in mutations(10_000):
        got = len([*reader.read(stream + b"\0")])
        assert got == sum(valid(frame) for frame in stream.split(b"\0"))
    assert reader.corrupt > 5_000
    assert [*reader.read(encode(FRAMES[0]))] == [FRAMES[0]]


def test_ten_thousand_bad_frames_at_the_rig() -> None:
    """The firmware does not fail, never drives, and still answers."""
    firmware = Firmware(-2048, 2047, 0)
    for stream in mutations(10_000):
        firmware.receive(stream)
        firmware.sample(0, 0, 0)
        assert firmware.code == 0
    firmware.receive(b"\0" + encode(frames.HelloFrame(1, 5, 1000, 50)))
    welcome, sensors = FrameReader().read(firmware.sample(1, 2, 3))
    assert welcome == frames.WelcomeFrame(1, 5, 1000, 50)
    assert isinstance(sensors, frames.SensorsFrame)
    assert (sensors.arm, sensors.speed, sensors.pendulum, sensors.sample) == (1, 2, 3, 1)


@settings(max_examples=300)
@given(st.lists(st.binary(max_size=300), max_size=20), st.data())
def test_the_stream_may_be_cut_anywhere(noise: list[bytes], data: st.DataObject) -> None:
    """Bytes may arrive in any pieces; after noise of any length the next frame is decoded."""
    stream = b"".join(noise) + b"\0" + b"".join(map(encode, FRAMES))
    whole = [*FrameReader().read(stream)]
    reader, pieces = FrameReader(), []
    while stream:
        cut = data.draw(st.integers(1, len(stream)))
        pieces += reader.read(stream[:cut])
        stream = stream[cut:]
    assert pieces[-len(FRAMES) :] == whole[-len(FRAMES) :] == FRAMES


def test_a_stream_without_zeros_is_discarded() -> None:
    """It uses no memory and is counted once."""
    reader = FrameReader()
    for _ in range(1000):
        assert [*reader.read(b"\x01" * 100)] == []
    assert reader.corrupt == 1
    assert [*reader.read(b"\0" + encode(FRAMES[2]))] == [FRAMES[2]]


def test_sample_numbers_wrap_around() -> None:
    """32 bits last 50 days at 1 kHz."""
    assert is_newer(0, 2**32 - 1)
    assert not is_newer(2**32 - 1, 0)
    assert not is_newer(5, 5)
