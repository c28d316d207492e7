"""Runs firmware as machine code of a Cortex-M processor, in the emulator unicorn."""

from pathlib import Path

from elf import Elf
from unicorn import UC_ARCH_ARM, UC_HOOK_CODE, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
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
# What a processor saves on the stack before an interrupt [bytes].
FRAME = 32


class Processor:
    """A processor with a program in its memory."""

    def __init__(self, processor: str, elf: Elf, stepping: bool = False) -> None:
        # unicorn stops after a number of instructions only in code that it has translated for this.
        self._limit = 2**40 if stepping else 0
        self.functions = elf.functions()
        self.uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self.uc.ctl_set_cpu_model(PROCESSORS[processor])
        blocks = (PROGRAM, PROGRAM_SIZE), (RETURN, 0x1000), (SCRIPT, BLOCK), (LOG, BLOCK)
        for address, size in (*blocks, (STACK, STACK_SIZE)):
            self.uc.mem_map(address, size)
        for address, content in elf.loaded():
            self.uc.mem_write(address, content)

    def _begin(self, function: str, *arguments: int, stack: int = STACK + STACK_SIZE) -> None:
        """Prepare a call."""
        for register, value in zip(ARGUMENTS, arguments, strict=False):
            self.uc.reg_write(register, value)
        self.uc.reg_write(UC_ARM_REG_SP, stack)
        self.uc.reg_write(UC_ARM_REG_LR, RETURN | 1)
        self.uc.reg_write(UC_ARM_REG_PC, self.functions[function] | 1)

    def call(self, function: str, *arguments: int) -> None:
        """Call a function."""
        self._begin(function, *arguments)
        self._run()
        assert self._ended()

    def _run(self, instructions: int | None = None) -> None:
        """Continue for so many instructions, or to the end."""
        start = self.uc.reg_read(UC_ARM_REG_PC) | 1
        self.uc.emu_start(start, RETURN, count=instructions or self._limit)

    def _ended(self) -> bool:
        return bool(self.uc.reg_read(UC_ARM_REG_PC) == RETURN)


class CortexM(Processor):
    """A processor with the firmware on the emulated board in its memory."""

    def __init__(self, processor: str, directory: Path, stepping: bool = False) -> None:
        file = directory / f"{processor}.elf"
        options = *MACHINE, f"-mcpu={processor}", "-g", "-Wl,-e,emulated_replay"
        compile_firmware(emulated_sources(), file, *options)
        super().__init__(processor, Elf(file), stepping)

    def replay(self, script: bytes) -> bytes:
        """Replay a script; returns the log."""
        assert LOG_FACTOR * len(script) < BLOCK
        self.uc.mem_write(SCRIPT, script)
        self.call("emulated_replay", SCRIPT, len(script), LOG)
        size = self.uc.reg_read(UC_ARM_REG_R0)
        return bytes(self.uc.mem_read(LOG, size))

    def count(self, script: bytes) -> int:
        """Replay a script; return how many instructions the firmware executes for it.

        Those of the script's interpreter are not counted, because a board has none.
        """
        executed = 0
        begin = self.functions["emulated_replay"] & ~1
        later = [address for address in self.functions.values() if address > begin + 1]
        end = min(later, default=PROGRAM_SIZE)

        def on_instruction(_: object, address: int, *__: object) -> None:
            nonlocal executed
            executed += not begin <= address < end

        self.uc.ctl_flush_tb()  # code that was translated before would not be counted
        hook = self.uc.hook_add(UC_HOOK_CODE, on_instruction)
        self.replay(script)
        self.uc.hook_del(hook)
        return executed

    def state(self) -> bytes:
        """The program's memory."""
        return bytes(self.uc.mem_read(PROGRAM, PROGRAM_SIZE))

    def restore(self, state: bytes) -> None:
        """Go back to the state of an earlier time."""
        self.uc.mem_write(PROGRAM, state)

    def replay_interrupted(self, after: int, script: bytes) -> tuple[bool, bytes]:
        """Replay a script, with ``furuta_tick`` as an interrupt after so many instructions.

        While the firmware holds off the interrupt, it waits. Returns whether it came before the
        end, and the log. Needs ``stepping``.
        """
        self.uc.mem_write(SCRIPT, script)
        self._begin("emulated_replay", SCRIPT, len(script), LOG)
        interrupted = self._interrupt(after)
        size = self.uc.reg_read(UC_ARM_REG_R0)
        return interrupted, bytes(self.uc.mem_read(LOG, size))

    def _interrupt(self, after: int) -> bool:
        self._run(after)
        while not self._ended() and self._locked():
            self._run(1)
        if self._ended():
            return False
        registers = self.uc.context_save()
        stack = self.uc.reg_read(UC_ARM_REG_SP) - FRAME & ~7
        self._begin("furuta_tick", stack=stack)
        self._run()
        self.uc.context_restore(registers)
        self._run()
        return True

    def _locked(self) -> bool:
        return self.uc.mem_read(self.functions["locks"], 1) != b"\0"
