"""A line to the emulated rig that damages frames, with an independent decoder."""

import struct
from zlib import crc32

import numpy as np
from cobs import cobs

from furuta_hw.protocol.frames import FORMATS, LONGEST_FRAME, FrameError, decode
from furuta_sim.emulator.emulated_rig import EmulatedRig
from soak.mutators import damaged_bytes
from soak.oracles import different_value
from soak.record import Record


class DamagedLine:
    """The host's port: it carries damaged bytes to the rig."""

    def __init__(self, rig: EmulatedRig, record: Record, random: np.random.Generator) -> None:
        self._rig, self._record, self._random = rig, record, random
        self.damaged = 0.0

    def read(self) -> bytes:
        """Read nothing: samples are passed on by hand."""
        return b""

    def write(self, data: bytes) -> None:
        """Send to the rig."""
        self._rig.receive(self.carry(data, "to rig"))

    def close(self) -> None:
        """Do nothing: there is nothing to free."""

    def carry(self, data: bytes, direction: str) -> bytes:
        """Carry bytes, perhaps damaged; each piece is also decoded independently."""
        if data and self._random.random() < self.damaged:
            data = damaged_bytes(self._random, data)
            for piece in data.split(b"\0")[:-1]:
                self._record.check("frames", different_value(_decoded(piece), _expected(piece)))
        return data


def _decoded(piece: bytes) -> tuple[int, ...] | None:
    try:
        return tuple(decode(piece))
    except FrameError:
        return None


def _expected(piece: bytes) -> tuple[int, ...] | None:
    """The fields of a frame by another implementation of COBS; None if it is invalid."""
    if not piece or len(piece) > LONGEST_FRAME:
        return None
    try:
        payload = cobs.decode(piece)
    except cobs.DecodeError:
        return None
    body, crc = payload[:-4], payload[-4:]
    if not body or struct.pack("<I", crc32(body)) != crc:
        return None
    layouts = dict(FORMATS.values())
    layout = layouts.get(body[0])
    if layout is None or len(body) != 1 + layout.size:
        return None
    return tuple(int(each) for each in layout.unpack(body[1:]))
