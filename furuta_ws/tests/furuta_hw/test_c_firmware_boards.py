"""The boards' files compile without warnings, and the encoder's decoder counts right."""

import ctypes
from pathlib import Path

import pytest

from furuta_hw.emulator.firmware_compiler import (
    ALONE,
    WARNINGS,
    compile_firmware,
    firmware_directory,
    run_compiler,
)

# Declarations of the Arduino cores in the place of their headers.
STAND_INS = Path(__file__).with_name("arduino")
TARGETS = {
    "avr": ("-target", "avr-freestanding-none", "-mmcu=atmega328p", "-mcpu=atmega328p"),
    "rp2040": ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m0plus"),
    "teensy4": ("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m7"),
}


@pytest.mark.parametrize("board", TARGETS)
def test_boards_compile(zig: None, board: str, tmp_path: Path) -> None:
    """With their processor's compiler, against declarations of their core's functions."""
    firmware = firmware_directory()
    folders = firmware / "core", STAND_INS / "common", STAND_INS / board
    language = "-x", "c++", "-std=c++17", "-include", "Arduino.h"
    includes = (f"-I{folder}" for folder in folders)
    source = firmware / "boards" / board / f"{board}.ino"
    out = tmp_path / "board.o"
    options = *TARGETS[board], *ALONE, *WARNINGS, "-Werror", *includes
    run_compiler("c++", "-c", *options, *language, "-o", out, source)
    assert out.stat().st_size > 0


class Encoder(ctypes.Structure):
    """``struct furuta_encoder``."""

    _fields_ = [("count", ctypes.c_int32), ("levels", ctypes.c_uint8)]


def test_encoder_counts_four_per_line(zig: None, tmp_path: Path) -> None:
    """Up while A leads B, down while B leads; a jump of both channels counts nothing."""
    library = tmp_path / "encoder.so"
    source = firmware_directory() / "core" / "furuta_encoder.c"
    compile_firmware([source], library, "-shared", "-fPIC")
    move = ctypes.CDLL(str(library)).furuta_encoder_move
    encoder = Encoder()
    line = [(True, False), (True, True), (False, True), (False, False)]
    counts = []
    for a, b in [*line, *line, *line[2::-1], (False, False), (True, True), (True, True)]:
        move(ctypes.byref(encoder), ctypes.c_bool(a), ctypes.c_bool(b))
        counts.append(encoder.count)
    assert counts == [1, 2, 3, 4, 5, 6, 7, 8, 7, 6, 5, 4, 4, 4]
