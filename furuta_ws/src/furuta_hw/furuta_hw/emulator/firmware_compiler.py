"""Compiles the C firmware for boards, with the compiler that the package ziglang contains."""

import os
import subprocess
import tempfile
from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_ros.installed_files import share_directory

try:
    import ziglang
except ImportError:  # only this needs it
    ziglang = None

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow")
# Nothing is linked to the firmware: neither a C library nor a run-time.
ALONE = ("-Os", "-ffreestanding", "-nostdlib")
OPTIONS = ("-std=c99", *ALONE, *WARNINGS, "-Wstrict-prototypes", "-Wmissing-prototypes")


def firmware_directory() -> Path:
    """Where the sources of the firmware are installed."""
    return share_directory("furuta_hw") / "firmware"


def core_sources() -> list[Path]:
    """The portable part."""
    return sorted((firmware_directory() / "core").glob("*.c"))


def emulated_sources() -> list[Path]:
    """The portable part on a board in the memory of a computer."""
    return [*core_sources(), firmware_directory() / "boards" / "emulated" / "emulated.c"]


def on_board_options(loop: Path) -> tuple[str | Path, ...]:
    """Options and sources for a loop on the board; ``loop`` is the folder of an exported one."""
    folder = firmware_directory() / "on_board"
    include = f"-I{folder}", f"-I{loop}"
    return "-DFURUTA_ON_BOARD", *include, folder / "furuta_on_board.c", loop / "loop.c"


def compiler() -> Path:
    """The executable of the compiler. Raises :class:`ParameterError` if it is not installed."""
    if ziglang is None:
        raise ParameterError(
            "the C firmware needs a compiler: install the Python package ziglang (docs/firmware.md)"
        )
    return Path(ziglang.__file__).parent / "zig"


def compile_firmware(sources: list[Path], out: Path, *options: str | Path) -> None:
    """Compile C files into ``out``. Raises :class:`ParameterError` with what the compiler says."""
    core = firmware_directory() / "core"
    run_compiler("cc", *OPTIONS, *options, f"-I{core}", "-o", out, *sources)


def run_compiler(*arguments: str | Path) -> None:
    """Run the compiler. Raises :class:`ParameterError` with what it says."""
    with tempfile.TemporaryDirectory() as cache:
        environment = os.environ | dict.fromkeys(
            ("ZIG_GLOBAL_CACHE_DIR", "ZIG_LOCAL_CACHE_DIR"), cache
        )
        command = [compiler(), *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode != 0:
        raise ParameterError(f"the C firmware cannot be compiled: {done.stderr.strip()}")
