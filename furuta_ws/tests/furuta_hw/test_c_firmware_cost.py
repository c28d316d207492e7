"""Size and instructions of the C firmware; warnings and sanitizers."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

import pytest
from elf import Elf
from firmware_schedules import Schedule

from furuta_hw.emulator.firmware_compiler import (
    compile_firmware,
    core_sources,
)
from furuta_hw.protocol import frames

if TYPE_CHECKING:
    from cortex_m import CortexM

TARGETS = {
    "ATmega328P": ("-target", "avr-freestanding-none", "-mmcu=atmega328p", "-mcpu=atmega328p"),
    "Cortex-M0+": ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m0plus"),
    "Cortex-M4": ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m4"),
    "Cortex-M7": ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m7"),
    "RISC-V": ("-target", "riscv32-freestanding-none", "-mcpu=baseline_rv32-d-f"),
}
EMULATED = {"Cortex-M0+": "cortex_m0plus", "Cortex-M4": "cortex_m4"}
# The limits for the firmware: 8 KiB, 1 KiB, and 5 % of 100 MHz at 1 kHz if an instruction takes
# one cycle.
CODE, MEMORY, INSTRUCTIONS = 8192, 1024, 5000


def sizes(target: str, directory: Path) -> tuple[int, int]:
    """Code with constants, and static memory of the core [bytes]."""
    code = memory = 0
    for source in core_sources():
        out = directory / f"{source.stem}.o"
        compile_firmware([source], out, *TARGETS[target], "-fno-unwind-tables", "-Werror", "-c")
        elf = Elf(out)
        code, memory = code + elf.code_size(), memory + elf.memory_size()
    return code, memory


def samples(count: int) -> list[bytes]:
    """Scripts: power-on, a session, then one per sample with the Drive frame that answers it."""
    random = Random(3)
    schedule = Schedule(random)
    schedule.start_session(0x1234)
    scripts = []
    for _ in range(count):
        done = len(schedule.script)
        schedule.sample(random.randrange(2**31), random.randrange(2**15), random.randrange(2**31))
        number = schedule.firmware.number
        schedule.send(frames.DriveFrame(0x1234, number, random.randrange(2048)))
        scripts.append(schedule.script[done:])
    assert schedule.firmware.driven == count
    return [schedule.script[: -sum(map(len, scripts))], *scripts]


def instructions(machine: CortexM) -> int:
    """Worst case of a sample with its answer."""
    start, *scripts = samples(200)
    machine.replay(start)
    return max(map(machine.count, scripts))


@pytest.mark.parametrize("target", TARGETS)
def test_size_and_cost(target: str, cortex_m: dict[str, CortexM], tmp_path: Path) -> None:
    """Within the limits."""
    code, memory = sizes(target, tmp_path)
    assert 500 < code < CODE
    assert 100 < memory < MEMORY
    if target in EMULATED:
        assert 500 < instructions(cortex_m[EMULATED[target]]) < INSTRUCTIONS
