"""Runs firmware as machine code of a Cortex-M processor, in the emulator unicorn."""

from pathlib import Path

from elf import Elf
from unicorn import UC_ARCH_ARM, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
from unicorn.arm_const import (
    UC_ARM_REG_LR,
    UC_ARM_REG_PC,
    UC_ARM_REG_R0,
    UC_ARM_REG_R1,
    UC_ARM_REG_R2,
    UC_ARM_REG_SP,
    UC_CPU_ARM_CORTEX_M0,
    UC_CPU_ARM_CORTEX_M4,
)

from furuta_hw.emulator.compiled_firmware import LOG_FACTOR
from furuta_hw.emulator.firmware_compiler import compile_firmware, emulated_sources

# Processor name of the compiler, and model of the emulator. The RP2040 has the first.
PROCESSORS = {"cortex_m0plus": UC_CPU_ARM_CORTEX_M0, "cortex_m4": UC_CPU_ARM_CORTEX_M4}
MACHINE = "-target", "thumb-freestanding-eabi", "-fno-unwind-tables", "-Werror"
ARGUMENTS = (UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2)

# Memory map: the program is linked below 256 KiB.
PROGRAM, PROGRAM_SIZE = 0, 0x40000
RETURN = 0x100000  # where the outermost function returns to
SCRIPT, LOG, BLOCK = 0x10000000, 0x20000000, 0x1000000
STACK, STACK_SIZE = 0x40000000, 0x10000


class Processor:
    """A processor with a program in its memory."""

    def __init__(self, processor: str, elf: Elf) -> None:
        self.functions = elf.functions()
        self.uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self.uc.ctl_set_cpu_model(PROCESSORS[processor])
        blocks = (PROGRAM, PROGRAM_SIZE), (RETURN, 0x1000), (SCRIPT, BLOCK), (LOG, BLOCK)
        for address, size in (*blocks, (STACK, STACK_SIZE)):
            self.uc.mem_map(address, size)
        for address, content in elf.loaded():
            self.uc.mem_write(address, content)

    def call(self, function: str, *arguments: int) -> None:
        """Call a function."""
        for register, value in zip(ARGUMENTS, arguments, strict=False):
            self.uc.reg_write(register, value)
        self.uc.reg_write(UC_ARM_REG_SP, STACK + STACK_SIZE)
        self.uc.reg_write(UC_ARM_REG_LR, RETURN | 1)
        self.uc.emu_start(self.functions[function] | 1, RETURN)
        assert self.uc.reg_read(UC_ARM_REG_PC) == RETURN


class CortexM(Processor):
    """A processor with the firmware on the emulated board in its memory."""

    def __init__(self, processor: str, directory: Path) -> None:
        file = directory / f"{processor}.elf"
        options = *MACHINE, f"-mcpu={processor}", "-g", "-Wl,-e,emulated_replay"
        compile_firmware(emulated_sources(), file, *options)
        super().__init__(processor, Elf(file))

    def replay(self, script: bytes) -> bytes:
        """Replay a script; returns the log."""
        assert LOG_FACTOR * len(script) < BLOCK
        self.uc.mem_write(SCRIPT, script)
        self.call("emulated_replay", SCRIPT, len(script), LOG)
        size = self.uc.reg_read(UC_ARM_REG_R0)
        return bytes(self.uc.mem_read(LOG, size))
