"""Size and instructions of the C firmware; warnings and sanitizers."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

import pytest
from elf import Elf
from firmware_schedules import Schedule, assert_same, random_schedule

from furuta_hw.protocol import frames
from furuta_sim.emulator.firmware_compiler import (
    compile_firmware,
    core_sources,
    emulated_sources,
    firmware_directory,
)

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


@pytest.mark.long
def test_undefined_behaviour_traps(zig: None) -> None:
    """In a process of its own, which a trap would end."""
    code = (
        "from furuta_sim.emulator.compiled_firmware import load_replay\n"
        "import sys; sys.path[:0] = sys.argv[1:]\n"
        "from firmware_schedules import assert_same, random_schedule\n"
        "replay = load_replay('-fsanitize=undefined', '-fsanitize-trap=undefined')\n"
        "for seed in range(40):\n"
        "    schedule = random_schedule(seed, 500)\n"
        "    assert_same(schedule, replay(schedule.script))\n"
    )
    tests = str(Path(__file__).resolve().parents[1])
    done = subprocess.run(
        [sys.executable, "-c", code, tests], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.long
def test_address_sanitizer(tmp_path: Path) -> None:
    """With the system's gcc, because ziglang has no run-time for it."""
    gcc = shutil.which("gcc")
    if gcc is None:
        pytest.skip("the address sanitizer needs gcc")
    program = tmp_path / "replay"
    sources = [*emulated_sources(), Path(__file__).with_name("replay_main.c")]
    options = "-std=c99", "-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"
    include = f"-I{firmware_directory() / 'core'}"
    built = subprocess.run(
        [gcc, *options, include, "-o", program, *sources],
        capture_output=True,
        text=True,
        check=False,
    )
    if "cannot find" in built.stderr:
        pytest.skip("gcc lacks the run-time of its sanitizers")
    assert (built.returncode, built.stderr) == (0, "")
    for seed in range(10):
        schedule = random_schedule(seed, 2000)
        done = subprocess.run([program], input=schedule.script, capture_output=True, check=True)
        assert_same(schedule, done.stdout)
