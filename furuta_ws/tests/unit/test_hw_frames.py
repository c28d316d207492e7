"""The wire protocol: what is encoded is decoded, and nothing else is."""

from __future__ import annotations

import re
import struct
from pathlib import Path
from zlib import crc32

import numpy as np
import pytest
from cobs import cobs
from hypothesis import given, settings
from hypothesis import strategies as st

from furuta_hw import frames
from furuta_hw.firmware import Firmware
from furuta_hw.frames import FrameError, FrameReader, decode, encode, newer, stuff, unstuff

PAGE = Path(__file__).resolve().parents[3] / "docs" / "hardware.md"
MESSAGES = [
    frames.Hello(1, 0x1234, 1000, 50),
    frames.Drive(0x1234, 0xFFFFFFFF, -2048),
    frames.Arm(0, 7),
    frames.Stop(0xFF00),
    frames.Welcome(1, 0x1234, 1000, 50),
    frames.Sensors(0x1234, 100000, 3, 99999, 65535, -250, 2047, -2048, 0),
]


def valid(frame: bytes) -> bool:
    """Whether a frame's CRC is right, told without the code under test."""
    try:
        payload = cobs.decode(frame)
    except cobs.DecodeError:
        return False
    return len(payload) > 4 and struct.pack("<I", crc32(payload[:-4])) == payload[-4:]


@pytest.mark.parametrize("message", MESSAGES, ids=lambda each: type(each).__name__)
def test_what_is_encoded_is_decoded(message: frames.Message) -> None:
    """Every message survives, in a frame with one zero byte, at its end."""
    frame = encode(message)
    assert frame.index(0) == len(frame) - 1
    assert len(frame) <= frames.LONGEST_FRAME
    assert decode(frame[:-1]) == message


@given(st.binary(max_size=frames.LONGEST_FRAME - 1))
def test_stuffing_is_cobs(payload: bytes) -> None:
    """The same bytes as an independent library, both ways."""
    assert stuff(payload) == cobs.encode(payload)
    assert unstuff(stuff(payload)) == payload


@given(st.binary(max_size=80))
def test_unstuffing_refuses_what_cobs_refuses(frame: bytes) -> None:
    """And gives what it gives elsewhere."""
    try:
        expected = cobs.decode(frame) if 0 < len(frame) <= frames.LONGEST_FRAME else None
    except cobs.DecodeError:
        expected = None
    try:
        got = unstuff(frame)
    except FrameError:
        got = None
    assert got == expected


def test_vectors_of_the_page_are_the_codes() -> None:
    """docs/hardware.md: each vector is a message's text and the bytes of its frame."""
    rows = re.findall(r"^\| `(\w+\([^`]*\))` \| `([0-9a-f ]+)` \|$", PAGE.read_text(), re.M)
    assert len(rows) >= len(frames.FORMATS)
    for text, hexadecimal in rows:
        message = eval(text, vars(frames))
        assert encode(message) == bytes.fromhex(hexadecimal), text


def test_layouts_of_the_page_are_the_codes() -> None:
    """docs/hardware.md: type number, fields in order, and size of each message."""
    text = PAGE.read_text()
    kinds = {"B": "u8", "H": "u16", "h": "i16", "I": "u32", "i": "i32"}
    for kind, (number, layout) in frames.FORMATS.items():
        fields = ", ".join(
            f"{name} {kinds[code]}"
            for name, code in zip(kind._fields, layout.format.lstrip("<"), strict=True)
        )
        row = f"| `0x{number:02x}` {kind.__name__} | {fields} | {1 + layout.size + 4} |"
        assert row in text, row


def mutations(count: int) -> list[bytes]:
    """Random bytes, and true frames changed, cut, joined, doubled; as streams with zeros."""
    random = np.random.default_rng(1)
    true = [encode(message) for message in MESSAGES]
    made = []
    for number in range(count):
        frame = bytearray(true[number % len(true)])
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
            frame = frame[:-1] + true[int(random.integers(len(true)))]
        made.append(bytes(frame))
    return made


def test_ten_thousand_bad_frames_at_the_host() -> None:
    """Nothing crashes, and exactly the frames whose CRC is right become messages."""
    reader = FrameReader()
    for stream in mutations(10_000):
        got = len(reader.feed(stream + b"\0"))
        assert got == sum(valid(frame) for frame in stream.split(b"\0"))
    assert reader.corrupt > 5_000
    assert reader.feed(encode(MESSAGES[0])) == [MESSAGES[0]]


def test_ten_thousand_bad_frames_at_the_rig() -> None:
    """The firmware lives, never drives, and still answers."""
    firmware = Firmware(-2048, 2047, 0)
    for stream in mutations(10_000):
        firmware.receive(stream)
        firmware.sample(0, 0, 0)
        assert firmware.code == 0
    firmware.receive(b"\0" + encode(frames.Hello(1, 5, 1000, 50)))
    welcome, sensors = FrameReader().feed(firmware.sample(1, 2, 3))
    assert welcome == frames.Welcome(1, 5, 1000, 50)
    assert isinstance(sensors, frames.Sensors)
    assert (sensors.arm, sensors.speed, sensors.pendulum, sensors.sample) == (1, 2, 3, 1)


@settings(max_examples=300)
@given(st.lists(st.binary(max_size=300), max_size=20), st.data())
def test_any_cutting_of_the_stream_is_the_same(noise: list[bytes], data: st.DataObject) -> None:
    """Bytes may come in any pieces; after noise of any length the next frame is understood."""
    stream = b"".join(noise) + b"\0" + b"".join(map(encode, MESSAGES))
    whole = FrameReader().feed(stream)
    reader, pieces = FrameReader(), []
    while stream:
        cut = data.draw(st.integers(1, len(stream)))
        pieces += reader.feed(stream[:cut])
        stream = stream[cut:]
    assert pieces[-len(MESSAGES) :] == whole[-len(MESSAGES) :] == MESSAGES


def test_a_stream_without_end_is_thrown_away() -> None:
    """A line that sends no zero byte fills no memory and counts once."""
    reader = FrameReader()
    for _ in range(1000):
        assert reader.feed(b"\x01" * 100) == []
    assert reader.corrupt == 1
    assert reader.feed(b"\0" + encode(MESSAGES[2])) == [MESSAGES[2]]


def test_sample_numbers_wrap_around() -> None:
    """32 bits last 50 days at 1 kHz."""
    assert newer(0, 2**32 - 1)
    assert not newer(2**32 - 1, 0)
    assert not newer(5, 5)
