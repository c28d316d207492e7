"""Every state of the firmware's core under every frame, tick and interrupt: docs/safety.md."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from sources import ROOT

HERE = Path(__file__).with_name("firmware")
CORE = ROOT / "furuta_ws" / "src" / "furuta_hw" / "firmware" / "core"
SOURCES = ("furuta_firmware.c", "furuta_frames.c", "furuta_rig.c")
# The hooks of the thread sanitizer without its run-time, and a trap for each undefined behaviour.
HOOKS = ("-fsanitize=thread,undefined,bounds", "-fsanitize-undefined-trap-on-error")
WARNINGS = ("-Wall", "-Wextra", "-Werror")

STALE = "rig->number - rig->answered >= rig->watchdog"
FRESH = "return rig->number - sample < rig->watchdog;"
NEWER = "return 0 < ahead && ahead < 0x80000000u;"
ARM = "    rig->answered = frame->sample;\n    rig->code = rig->limits.zero_code;"
ALLOWED = "rig->fault || !is_fresh(rig, frame->sample)"
SESSION = "!rig->in_session || frame->session != rig->session"
TAKE = "static bool take_newest(struct furuta_sample *sample) {\n    board_"
FORGET = "        unsent = false; /* a sample of the session before */"
REJECT = "        rig.discarded++;\n    }"
DISCARD = "    board_lock();\n    rig.discarded++;\n    board_unlock();"
# One fault each: file, old text, new text.
MUTANTS = [
    ("rig", STALE, STALE.replace(">=", ">")),
    ("rig", FRESH, FRESH.replace("<", "<=")),
    ("rig", FRESH, "return sample + rig->watchdog > rig->number;"),
    ("rig", NEWER, "return ahead < 0x80000000u;"),
    ("rig", "rig->status &= (uint8_t)~FURUTA_ARMED;", ""),
    ("rig", ALLOWED, "!is_fresh(rig, frame->sample)"),
    ("rig", ARM, "    rig->code = rig->limits.zero_code;"),
    ("rig", "(rig->status & FURUTA_ARMED) == 0 || !is_fresh", "!is_fresh"),
    ("rig", "frame->code < limits->lowest_code ||", ""),
    ("rig", SESSION, "frame->session != rig->session"),
    ("rig", "    case FURUTA_STOP:\n        disarm(rig);", "    case FURUTA_STOP:"),
    ("rig", "hello->version == FURUTA_VERSION", "true"),
    ("rig", "    if (rig->fault) {\n        disarm(rig);", "    if (rig->fault) {"),
    (
        "firmware",
        "    furuta_advance(&rig);\n    board_drive(rig.code);",
        "    furuta_advance(&rig);",
    ),
    ("firmware", "rig.fault = board_fault();\n    if", "if"),
    ("firmware", f"{REJECT}\n    board_drive(rig.code);", REJECT),
    ("firmware", FORGET, ""),
    ("firmware", f"{TAKE}lock();", f"{TAKE}unlock();"),
    ("firmware", DISCARD, "    rig.discarded++;"),
    ("frames", "return size == 9u;", "return true;"),
]
# Those that are refuted within a second or some.
FAST = (0, 14)
# Faults of reading a frame need frames byte by byte.
INSTANCES = {"rig": ("2", "1"), "firmware": ("2", "1"), "frames": ("1", "0")}


@pytest.fixture(scope="module")
def gcc() -> str:
    """The system's compiler: the explorer needs the hooks of gcc."""
    found = shutil.which("gcc")
    if found is None:
        pytest.skip("the explorer of the firmware needs gcc")
    return found


def explorer(gcc: str, directory: Path, file: str = "", old: str = "", new: str = "") -> Path:
    """Compile the core, or a mutant of it, with the explorer."""
    for source in CORE.iterdir():
        shutil.copy(source, directory)
    if file:
        mutant = directory / f"furuta_{file}.c"
        text = mutant.read_text()
        assert text.count(old) == 1, f"{mutant.name} has {text.count(old)} times {old!r}"
        mutant.write_text(text.replace(old, new))
    include, warnings = f"-I{directory}", () if file else WARNINGS
    core, program = directory / "core.o", directory / "explore"
    for command in (
        [*warnings, "-std=c99", "-O2", *HOOKS, "-c", HERE / "core.c", "-o", core],
        [*WARNINGS, "-std=gnu99", "-O3", HERE / "explore.c", core, "-o", program],
    ):
        subprocess.run([gcc, include, *command], check=True, capture_output=True)
    return program


@pytest.mark.parametrize(
    ("longest", "whole"),
    [
        (1, 1),
        pytest.param(2, 1, marks=pytest.mark.long),
        pytest.param(1, 0, marks=[pytest.mark.long, pytest.mark.timeout(3600)]),
    ],
)
def test_every_state_is_safe(gcc: str, tmp_path: Path, longest: int, whole: int) -> None:
    """With a watchdog of so many samples, and frames that come in one piece or byte by byte."""
    program = explorer(gcc, tmp_path)
    done = subprocess.run(
        [program, str(longest), str(whole)], check=False, capture_output=True, text=True
    )
    print(done.stdout)
    assert done.returncode == 0, done.stdout
    assert "states" in done.stdout


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        pytest.param(*mutant, marks=() if k in FAST else pytest.mark.long)
        for k, mutant in enumerate(MUTANTS)
    ],
)
def test_every_fault_is_refuted(gcc: str, tmp_path: Path, file: str, old: str, new: str) -> None:
    """By a rule that is broken, an unsafe state, or a trap."""
    program = explorer(gcc, tmp_path, file, old, new)
    done = subprocess.run([program, *INSTANCES[file]], check=False, capture_output=True, text=True)
    print(done.stdout)
    assert done.returncode not in (0, 2), done.stdout


def test_the_core_does_not_divide() -> None:
    """A division takes a time that depends on the numbers, and could be by zero."""
    for source in SOURCES:
        code = re.sub(r"/\*.*?\*/|#include.*?$", "", (CORE / source).read_text(), flags=re.S | re.M)
        assert not re.search(r"[/%]", code), source
