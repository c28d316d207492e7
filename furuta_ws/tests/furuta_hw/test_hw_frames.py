"""Frames of the serial protocol: encoding, decoding and invalid bytes."""

import re
import struct
from pathlib import Path
from zlib import crc32

from cobs import cobs
from hypothesis import given, settings
from hypothesis import strategies as st

from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import FrameError, FrameReader, decode, encode, stuff, unstuff

PAGE = Path(__file__).resolve().parents[3] / "docs" / "hardware.md"
# Name in docs/hardware.md, lowest and highest value of each type of field.
KINDS = {
    "B": ("u8", 0, 2**8 - 1),
    "H": ("u16", 0, 2**16 - 1),
    "h": ("i16", -(2**15), 2**15 - 1),
    "I": ("u32", 0, 2**32 - 1),
    "i": ("i32", -(2**31), 2**31 - 1),
}


def documented_name(kind: type[frames.Frame]) -> str:
    """The name of a frame in docs/hardware.md."""
    return kind.__name__.removesuffix("Frame")


def kinds(layout: struct.Struct) -> list[tuple[str, int, int]]:
    """The types of a frame's fields."""
    return [KINDS[code] for code in layout.format.lstrip("<")]


def frames_of(kind: type[frames.Frame]) -> st.SearchStrategy[frames.Frame]:
    """Frames of a kind with any values."""
    _, layout = frames.FORMATS[kind]
    fields = [st.integers(low, high) for _, low, high in kinds(layout)]
    return st.tuples(*fields).map(lambda values: kind(*values))


FRAMES = st.sampled_from([*frames.FORMATS]).flatmap(frames_of)
NOISE = st.binary(max_size=90)


def is_valid(frame: bytes) -> bool:
    """Whether bytes are a frame's, found without the code under test."""
    try:
        payload = cobs.decode(frame)
    except cobs.DecodeError:
        return False
    sizes = {number: 5 + layout.size for number, layout in frames.FORMATS.values()}
    right = len(payload) > 4 and struct.pack("<I", crc32(payload[:-4])) == payload[-4:]
    return right and sizes.get(payload[0]) == len(payload)


@given(FRAMES)
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
    for kind, (number, layout) in frames.FORMATS.items():
        typed = zip(kind._fields, kinds(layout), strict=True)
        fields = ", ".join(f"{name} {documented}" for name, (documented, _, _) in typed)
        row = f"| `0x{number:02x}` {documented_name(kind)} | {fields} | {1 + layout.size + 4} |"
        assert row in text, row


@settings(max_examples=500)
@given(st.lists(NOISE | FRAMES.map(encode), max_size=10), NOISE, FRAMES, st.data())
def test_a_reader_finds_the_valid_frames(
    pieces: list[bytes], new: bytes, last: frames.Frame, data: st.DataObject
) -> None:
    """Of changed bytes in pieces of any size: no other ones, and the next frame after them."""
    stream = b"".join(pieces)
    at, end = sorted(data.draw(st.integers(0, len(stream))) for _ in range(2))
    stream = stream[:at] + new + stream[end:] + b"\0" + encode(last)
    reader, found = FrameReader(), []
    size = data.draw(st.integers(1, 100))
    for start in range(0, len(stream), size):
        found += reader.read(stream[start : start + size])
    assert len(found) == sum(is_valid(frame) for frame in stream.split(b"\0"))
    assert found[-1] == last


@given(st.integers(0, 2**32 - 1), st.integers(1, 2**31 - 1))
def test_sample_numbers_wrap_around(sample: int, later: int) -> None:
    """32 bits last 50 days at 1 kHz."""
    assert frames.is_newer((sample + later) % 2**32, sample)
    assert not frames.is_newer(sample, (sample + later) % 2**32)
    assert not frames.is_newer(sample, sample)
