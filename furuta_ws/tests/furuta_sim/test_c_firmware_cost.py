"""Size, stack and instructions of the C firmware; warnings and sanitizers.

``--capture=no`` prints the table of docs/firmware.md.
"""

from __future__ import annotations

import re
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
from furuta_hw.protocol.frames import encode
from furuta_sim.emulator.firmware_compiler import (
    compile_firmware,
    core_sources,
    emulated_sources,
    firmware_directory,
)

if TYPE_CHECKING:
    from cortex_m import CortexM

PAGE = Path(__file__).resolve().parents[3] / "docs" / "firmware.md"
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
# Bytes that a line of 1 Mbit/s carries in a millisecond.
LINE_BYTES = 100


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


def instructions(machine: CortexM) -> tuple[int, int, int]:
    """Worst case of the interrupt, of a sample with its answer, and with a line full of Hello."""
    start, *scripts = samples(200)
    machine.replay(start)
    tick = machine.count_function("furuta_tick")
    answered = max(map(machine.count, scripts))
    schedule = Schedule(Random(0))
    schedule.start_session()
    done = len(schedule.script)
    schedule.sample(-1, -1, -1)
    hello = encode(frames.HelloFrame(frames.VERSION, 0x1234, 1000, 50))
    schedule.receive((hello * LINE_BYTES)[:LINE_BYTES])
    machine.replay(schedule.script[:done])
    return tick, answered, machine.count(schedule.script[done:])


def stack(machine: CortexM) -> int:
    """Deepest stack over random schedules, and of the interrupt on top of it [bytes]."""
    scripts = [random_schedule(seed, 200).script for seed in range(5)]
    loop = machine.stack_use(lambda: [machine.replay(script) for script in scripts])
    return loop + machine.stack_use(lambda: machine.call("furuta_tick"))


def documented() -> dict[str, list[str]]:
    """The rows of the page's table by processor."""
    rows = re.findall(r"^\| (ATmega328P|Cortex-M\S+|RISC-V) \|(.*)\|$", PAGE.read_text(), re.M)
    return {name: [each.strip() for each in cells.split("|")] for name, cells in rows}


@pytest.mark.parametrize("target", TARGETS)
def test_size_and_cost(target: str, cortex_m: dict[str, CortexM], tmp_path: Path) -> None:
    """Within the limits, and as docs/firmware.md says to 10 %."""
    code, memory = sizes(target, tmp_path)
    assert 500 < code < CODE
    assert 100 < memory < MEMORY
    row = [code, memory]
    if target in EMULATED:
        machine = cortex_m[EMULATED[target]]
        row += [stack(machine), *instructions(machine)]
        assert row[4] < INSTRUCTIONS
    cells = [f"{each}" for each in row] + ["–"] * (6 - len(row))
    print(f"\n| {target} | {' | '.join(cells)} |")
    for got, said in zip(cells, documented()[target], strict=True):
        assert got == said or abs(int(got) - int(said)) <= 0.1 * int(said)


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
