"""Exported loops as machine code, and the runs that they are compared with.

A run is a closed loop with noise whose readings are disturbed at random: missing ones, outliers,
gaps that end the estimate, falls, kicks, resets.
"""

import ctypes
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from elf import Elf
from sources import ROOT

from furuta.export.loop_files import loop_files
from furuta.export.values import DOUBLE, FLOAT, Precision
from furuta_control import control as controller
from furuta_hw.emulator.firmware_compiler import run_compiler
from furuta_hw.rigs.rig import Rig
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled
from furuta_model.state import APPLIED_TORQUE, PHI, PHI_DOT, SIGNALS, THETA, THETA_DOT
from furuta_sim.plant import NOISE_CHANNELS, Plant, design_plant, initial_plant, move, read
from furuta_sim.simulation import control_system
from furuta_sim.simulation.closed_loop import Loop
from furuta_sim.simulation.control_system import (
    ControlMemory,
    control_sample,
    design_control_system,
)

PAPER = Rig()
WARNINGS = "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wstrict-prototypes", "-Werror"
# Functions of math.h are those of this process: to build the C library would take long.
LIBRARY = "-std=c99", "-O2", "-shared", "-fPIC", "-nostdlib", *WARNINGS
TARGETS = {
    "Cortex-M4": ("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4+vfp4d16sp"),
    "Cortex-M0+": ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m0plus"),
    "RISC-V": ("-target", "riscv32-freestanding-none", "-mcpu=baseline_rv32-d"),
}
X86 = "-target", "x86_64-freestanding-none"
ALONE = "-std=c99", "-O2", "-ffreestanding", "-fno-math-errno", "-fno-unwind-tables", *WARNINGS
PRECISIONS = {"double": DOUBLE, "float": FLOAT}
# In place of a C library.
MEMORY = Path(__file__).with_name("export_memory.c")
STAND_INS = Path(__file__).parent / "furuta" / "ros2_control"
EXAMPLES = ROOT / "examples" / "ros2_control"
REPLAY = Path(__file__).with_name("export_replay.c")
NOTHING, RESET, FORGET = range(3)
# Probabilities per sample of a missing reading, an outlier, a gap of all, a kick, and a reset.
MISSING, OUTLIER, GAP, KICK, ANEW, FORGOTTEN = 2e-3, 1e-3, 5e-5, 2e-4, 2e-4, 1e-3
GAP_SAMPLES = 30
# Samples after which a pendulum that has fallen is put back.
PUT_BACK = 400


class Run(NamedTuple):
    """Readings (n, 5), actions (n,), and what the loop made of them (n, 7): u, F̂ [V], estimate."""

    readings: np.ndarray
    actions: np.ndarray
    results: np.ndarray


class Recorder:
    """Runs a loop under disturbances, part by part."""

    def __init__(self, loop: Loop, seed: int = 0) -> None:
        self._plant = design_plant(loop.plant)
        self._system = block(design_control_system(loop.estimator, loop.observer, loop.controller))
        self._memory = new_memory(ControlMemory)
        self._rig = initial_plant(loop.plant)
        self._start = self._rig["x"][0].copy()
        self._random = np.random.default_rng(seed)
        self._counts = np.zeros(2, dtype=np.int64)

    def run(self, samples: int) -> Run:
        """Continue for so many samples."""
        run = Run(
            np.empty((samples, SIGNALS)),
            np.zeros(samples, dtype=np.uint8),
            np.empty((samples, 2 + SIGNALS)),
        )
        _record(
            self._rig, self._memory, self._random, self._plant, self._system, self._start,
            self._counts, *run,
        )  # fmt: skip
        return run


@compiled
def _record(
    rig: np.ndarray,
    memory: np.ndarray,
    random: np.random.Generator,
    plant: Plant,
    system: np.ndarray,
    start: np.ndarray,
    counts: np.ndarray,
    readings: np.ndarray,
    actions: np.ndarray,
    results: np.ndarray,
) -> None:
    measurement, estimate, noise = np.empty(SIGNALS), np.empty(SIGNALS), np.zeros(NOISE_CHANNELS)
    x, torque = rig[0].x, 0.0
    for k in range(len(actions)):
        for channel in range(NOISE_CHANNELS):
            noise[channel] = random.standard_normal()
        counts[0] = counts[0] + 1 if abs(x[THETA]) > 1.0 else 0
        if random.random() < ANEW or counts[0] > PUT_BACK:
            x[:] = start
            x[PHI] += random.standard_normal()
            counts[0], actions[k] = 0, RESET
            control_system.reset(memory[0])
        elif random.random() < FORGOTTEN:
            actions[k] = FORGET
            controller.forget_integrals(memory[0].controller)
        if random.random() < KICK:
            x[THETA_DOT] += 3.0 * random.standard_normal()
        read(rig[0], noise, plant, measurement)
        measurement[APPLIED_TORQUE] = torque
        _disturb(measurement, random, counts)
        readings[k] = measurement
        friction, u = control_sample(memory[0], measurement, system[0], estimate)
        results[k, 0], results[k, 1], results[k, 2:] = u, friction, estimate
        torque = move(rig[0], u, plant)


@compiled
def _disturb(measurement: np.ndarray, random: np.random.Generator, counts: np.ndarray) -> None:
    signal = random.integers(0, SIGNALS)
    if random.random() < MISSING:
        measurement[signal] = np.nan
    if random.random() < OUTLIER:
        measurement[signal] += 10.0 ** random.integers(-2, 6) * random.standard_normal()
    if random.random() < GAP:
        counts[1] = random.integers(1, GAP_SAMPLES)
    if counts[1] > 0:
        counts[1] -= 1
        measurement[PHI : PHI_DOT + 1] = np.nan
        measurement[THETA] = np.nan


class CompiledLoop:
    """An exported loop as a library of this computer."""

    def __init__(self, loop: Loop, directory: Path, precision: Precision = DOUBLE) -> None:
        write_loop(loop, directory, precision)
        self._library = load(directory, directory / "loop.c", REPLAY)
        self._real = np.float32 if precision is FLOAT else np.float64
        self._memory = np.zeros(self._library.memory_size(), dtype=np.uint8)
        self._library.loop_init(_pointer(self._memory))

    def run(self, readings: np.ndarray, actions: np.ndarray) -> np.ndarray:
        """Continue with these readings; returns what :class:`Run` calls results."""
        given = readings.astype(self._real)
        commands = np.empty((len(actions), 2 + SIGNALS), self._real)
        self._library.replay(
            ctypes.c_int64(len(actions)), *map(_pointer, (given, actions, commands, self._memory))
        )
        return commands


def write_loop(
    loop: Loop, directory: Path, precision: Precision = DOUBLE, rig: Rig = PAPER
) -> None:
    """Write the files of a loop."""
    for name, content in loop_files(loop, rig, precision, "Loop of a test.").items():
        (directory / name).write_text(content)


def load(directory: Path, *sources: str | Path) -> ctypes.CDLL:
    """Compile sources beside a loop to a library, and load it."""
    library = directory / f"{len(list(directory.iterdir()))}.so"  # a name is loaded only once
    run_compiler("cc", *LIBRARY, f"-I{directory}", "-o", library, *sources)
    return ctypes.CDLL(str(library))


def assert_gain_is_tested(directory: Path, name: str, gain: str) -> None:
    """The test program passes as it is, and fails if a gain is changed by 1 %."""
    main, sources = f"{name}_test", (directory / f"{name}.c", directory / f"{name}_test.c")
    assert getattr(load(directory, f"-Dmain={main}", *sources), main)() == 0
    text, count = re.subn(rf"({gain}) = (\S+);", r"\1 = (1.01f) * (\2);", sources[0].read_text())
    assert count == 1
    sources[0].write_text(text)
    assert getattr(load(directory, f"-Dmain={main}", *sources), main)() == 1


def assert_small(source: Path, precision: str, least: int, most: int) -> None:
    """On other processors: no warning, no C library, no static memory, so much code [bytes]."""
    warnings = ["-Wdouble-promotion"] if precision == "float" else []
    out = source.with_suffix(".o")
    for target in (*TARGETS.values(), X86):
        run_compiler("cc", *ALONE, *warnings, *target, "-c", "-o", out, source)
        if target is not X86:
            elf = Elf(out)
            assert least < elf.code_size() < most
            assert elf.memory_size() == 0


class OnProcessor:
    """Exported code in float on an emulated Cortex-M4 with its floating-point unit."""

    def __init__(self, directory: Path, name: str, board: Path, entry: str) -> None:
        elf, sources = directory / f"{name}.elf", (directory / f"{name}.c", board, MEMORY)
        options = *TARGETS["Cortex-M4"], "-g", "-nostdlib", f"-Wl,-e,{entry}", f"-I{directory}"
        run_compiler("cc", *ALONE, *options, "-o", elf, *sources)
        from cortex_m import LOG, SCRIPT, Processor  # noqa: PLC0415 - needs unicorn
        from unicorn import UC_HOOK_CODE  # noqa: PLC0415 - the same

        self._processor, self._instructions = Processor("cortex_m4", Elf(elf)), 0
        self._places = SCRIPT, SCRIPT + 0x10000, LOG  # memory, what is given, results
        self._processor.uc.hook_add(UC_HOOK_CODE, self._count)
        self._processor.call(f"{name}_init", SCRIPT)

    def _count(self, *_: object) -> None:
        self._instructions += 1

    def costs(self, function: str, given: np.ndarray, expected: np.ndarray) -> list[int]:
        """Instructions of each call; its results have the bits that are ``expected``."""
        costs, (_, place, found) = [], self._places
        for row, results in zip(given, expected, strict=True):
            self._processor.uc.mem_write(place, row.astype(np.float32).tobytes())
            self._instructions = 0
            self._processor.call(function, *self._places)
            read = self._processor.uc.mem_read(found, 4 * results.size)
            np.testing.assert_array_equal(np.frombuffer(read, np.float32), np.ravel(results))
            costs.append(self._instructions)
        return costs


def compile_controller(directory: Path, source: Path) -> None:
    """Compile a controller against stand-ins for the headers of ros2_control."""
    stand_in = (STAND_INS / "controller_interface.hpp").read_text()
    macro = "#define PLUGINLIB_EXPORT_CLASS(Class, Base) static Base *made() { return new Class; }"
    headers = {
        "controller_interface/controller_interface.hpp": stand_in,
        "controller_interface/chainable_controller_interface.hpp": stand_in,
        "pluginlib/class_list_macros.hpp": macro,
        "rclcpp/logging.hpp": "",
    }
    for name, content in headers.items():
        (directory / name).parent.mkdir(exist_ok=True)
        (directory / name).write_text(f"{content}\n")
    options = "-std=c++17", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function", f"-I{directory}"
    run_compiler("c++", *options, "-c", "-o", directory / "controller.o", source)


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
