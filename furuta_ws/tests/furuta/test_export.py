"""Exported C gives the commands of the nodes: to the last bit in double, nearly in float."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_loop import (
    EXAMPLES,
    PRECISIONS,
    WARNINGS,
    CompiledLoop,
    OnProcessor,
    Recorder,
    Run,
    assert_gain_is_tested,
    assert_small,
    compile_controller,
    write_loop,
)

import furuta
from furuta.export.functions import Translation
from furuta.export.structures import structures
from furuta.export.values import DOUBLE, FLOAT, REAL, ExportError, Known, Number
from furuta_hw.emulator.firmware_compiler import run_compiler
from furuta_model.friction.parameters import Friction
from furuta_sim.simulation.closed_loop import Loop

pytest.importorskip("ziglang", reason="pip install -r firmware/requirements.lock")
pytest.importorskip("unicorn", reason="pip install -r firmware/requirements.lock")

SWING_UP = {"rig": "paper_full_turn", "mode": "swing_up", "method": "whole_circle"}
USUAL: dict[str, dict[str, Any]] = {
    "lugre": {"compensation": "lugre"},
    "lowpass": {"method": "lowpass", "compensation": "coulomb"},
    "qube": {"rig": "qube_servo_2", "compensation": "recommended"},
    "swing_up": {**SWING_UP, "swing_up.recover": True, "compensation": "adaptive"},
}
FURTHER: dict[str, dict[str, Any]] = {
    **{name: {"compensation": name} for name in ("none", "coulomb", "stiction", "adaptive")},
    "late": {"compensation": "recommended", "drive.delay": 10, "drive.lag": 0.015},
    "whole_circle": {"method": "whole_circle", "compensation": "lugre"},
    "integral": {"compensation": "recommended", "integral_time": 1.0, "strength": 0.7},
    "ideal": {"sensors.ideal": True, "compensation": "lugre"},
    "ideal_lowpass": {"sensors.ideal": True, "method": "lowpass", "compensation": "coulomb"},
    "swing_up_once": {**SWING_UP, "compensation": "lugre"},
    "odrive": {"rig": "odrive_furuta", "compensation": "adaptive"},
    "disabled": {"enabled": False},
}
CASES = USUAL | FURTHER
# Samples of all cases together, in parts.
ALL_SAMPLES, PART = 10_000_000, 100_000
# Largest deviation of a float's command where no sign or threshold differs [V]; the drive of the
# paper has steps of 0.005 V.
FLOAT_DEVIATION = 1e-4
BOARD = Path(__file__).with_name("export_board.c")


def loop_of(case: dict[str, Any]) -> Loop:
    return furuta.make_loop({k: v for k, v in case.items() if k != "rig"}, rig=case.get("rig"))


def assert_same(loop: CompiledLoop, run: Run) -> None:
    """Command, friction estimate and state estimate have the same bits, or are NaN."""
    results = loop.run(run.readings, run.actions)
    assert not np.any((results != run.results) & ~(np.isnan(results) & np.isnan(run.results)))


@pytest.mark.parametrize("case", USUAL)
def test_commands_have_the_same_bits(case: str, tmp_path: Path) -> None:
    """In a noisy loop with missing readings, outliers, gaps, kicks, falls and resets."""
    loop = loop_of(CASES[case])
    run = Recorder(loop).run(25_000)
    assert_same(CompiledLoop(loop, tmp_path), run)
    assert np.isnan(run.results).any() and len(np.unique(run.results[:, 0])) > 1000


@pytest.mark.long
@pytest.mark.parametrize("case", CASES)
def test_commands_have_the_same_bits_for_long(case: str, tmp_path: Path) -> None:
    """Ten million samples, shared by all cases."""
    loop = loop_of(CASES[case])
    recorder, exported = Recorder(loop, seed=1), CompiledLoop(loop, tmp_path)
    for _ in range(-(-ALL_SAMPLES // (PART * len(CASES)))):
        assert_same(exported, recorder.run(PART))


@pytest.mark.parametrize("case", ["lugre", "swing_up"])
def test_floats_deviate_little(case: str, tmp_path: Path) -> None:
    """On the same readings, over falls and resets."""
    loop = loop_of(CASES[case])
    run = Recorder(loop).run(25_000)
    results = CompiledLoop(loop, tmp_path, FLOAT).run(run.readings, run.actions)
    assert (np.isnan(results) == np.isnan(run.results)).all()
    assert np.nanmax(np.abs(results[:, :2] - run.results[:, :2])) < FLOAT_DEVIATION


@pytest.mark.parametrize(("case", "precision"), [("odrive", "double"), ("lugre", "float")])
def test_the_test_program_finds_a_wrong_gain(case: str, precision: str, tmp_path: Path) -> None:
    loop = loop_of(CASES[case])
    write_loop(loop, tmp_path, PRECISIONS[precision])
    assert_gain_is_tested(tmp_path, "loop", "balance_gain_l3")


@pytest.mark.parametrize(("case", "precision"), [("lugre", "float"), ("swing_up", "double")])
def test_size_on_other_processors(case: str, precision: str, tmp_path: Path) -> None:
    """And the header is one of C++ too."""
    write_loop(loop_of(CASES[case]), tmp_path, PRECISIONS[precision])
    assert_small(tmp_path / "loop.c", precision, 2000, 25_000)
    header, out = f"-I{tmp_path}", tmp_path / "user.o"
    (tmp_path / "user.cpp").write_text(
        '#include "loop.h"\nvoid (*step)(loop_memory *) = loop_init;'
    )
    run_compiler("c++", "-std=c++17", *WARNINGS[:4], header, "-c", "-o", out, tmp_path / "user.cpp")


def test_ros2_control_example_compiles(tmp_path: Path) -> None:
    """Against stand-ins for the headers of ros2_control, which are not installed here."""
    write_loop(loop_of(USUAL["lugre"]), tmp_path, FLOAT)
    compile_controller(tmp_path, EXAMPLES / "furuta_loop_controller.cpp")


def test_cost_on_a_cortex_m4(tmp_path: Path) -> None:
    """Floats have the bits of this computer's; below 1000 instructions in a usual sample."""
    loop = loop_of(USUAL["lugre"])
    run = Recorder(loop).run(1500)
    actions = np.zeros_like(run.actions)
    expected = CompiledLoop(loop, tmp_path, FLOAT).run(run.readings, actions)
    machine = OnProcessor(tmp_path, "loop", BOARD, "board_start")
    costs = machine.costs("loop_step", run.readings, expected)
    assert 300 < np.median(costs) < 1000
    assert max(costs) < 3000


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"mode": "off"}, "controller.mode must be one of balance, swing_up"),
        ({"excitation.kind": "sine"}, "excitation.kind must be none"),
    ],
)
def test_what_is_refused(values: dict[str, Any], message: str, tmp_path: Path) -> None:
    """With one line that says what is allowed."""
    with pytest.raises(ExportError, match=message):
        write_loop(furuta.make_loop(values), tmp_path)


def with_raise(x: float) -> float:
    if x > 1.0:
        raise ArithmeticError
    return x


OTHER = Friction(alpha0=0.1)


def with_another_meaning(x: float, p: Friction) -> float:
    if x > 1.0:
        p = OTHER
    return p.alpha0 * x


def test_a_branch_gives_no_other_meaning() -> None:
    """What is no number would keep the meaning of the branch after it."""
    known = {"x": Number(REAL, "x"), "p": Known(Friction(), "p")}
    with pytest.raises(ExportError, match="p is no number, and means something else in a branch"):
        Translation(DOUBLE, "").function(with_another_meaning, known)


def with_a_word_inside(x: float) -> float:
    short = x * x
    return short * short


def with_a_word_given(register: float) -> float:
    return 2.0 * register


@dataclass
class MemoryWithAWord:
    """A memory."""

    long: float = 0.0


@pytest.mark.parametrize(
    ("function", "argument", "word"),
    [(with_a_word_inside, "x", "short"), (with_a_word_given, "register", "register")],
)
def test_words_of_c_are_no_names(function: Any, argument: str, word: str) -> None:
    with pytest.raises(ExportError, match=f"{word} is a word of C; rename it"):
        Translation(DOUBLE, "").function(function, {argument: Number(REAL, argument)})


def test_words_of_c_are_no_fields() -> None:
    whole = Translation(DOUBLE, "")
    whole.used_fields.add((MemoryWithAWord, "long"))
    with pytest.raises(ExportError, match="long is a word of C; rename it"):
        structures(whole, MemoryWithAWord)


def test_errors_name_line_and_reason() -> None:
    """Of statements outside the subset of Python."""
    line = with_raise.__code__.co_firstlineno + 2
    with pytest.raises(ExportError, match=rf"test_export, line {line}, .*no Raise in C"):
        Translation(DOUBLE, "").function(with_raise, {"x": Number(REAL, "x")})
