"""The notebooks of the course use what the library has. ``make course CHECK=1`` runs them."""

import ast
import importlib
import os
import re
import subprocess
import sys
from functools import partial
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sources import ROOT, loaded

import furuta

COURSE = ROOT / "course"
NAMES = sorted(path.stem for path in COURSE.glob("[1-9]_*.md"))


def notebooks() -> ModuleType:
    """The script that makes the notebooks."""
    return loaded(COURSE / "notebooks.py")


@pytest.mark.parametrize("name", NAMES)
def test_code_uses_what_the_library_has(name: str) -> None:
    """Every cell is valid Python, and every name of the library exists."""
    script, text = notebooks(), (COURSE / f"{name}.md").read_text(encoding="utf-8")
    module = "library" if "import furuta as library" in text else "furuta"
    exercise, solution = script.exercise(text), script.solution(text)
    assert "SOLUTION" not in exercise + solution
    for code in (*script.code_cells(exercise), *script.code_cells(solution)):
        ast.parse(code)
        used = set(re.findall(rf"\b{module}\.(\w+)", code))
        assert used <= set(furuta.__all__), used
    assert exercise != solution


@pytest.mark.parametrize(("user", "allowed"), [("0", True), ("1000", False)])
def test_the_course_starts_as_root_too(
    user: str, allowed: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Jupyter refuses root, the user of most containers, unless it is allowed."""
    (tmp_path / "id").write_text(f"#!/bin/sh\necho {user}\n", encoding="utf-8")
    (tmp_path / "id").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    done = subprocess.run(
        ["make", "--dry-run", "course"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert "jupyter lab" in done.stdout
    assert ("--allow-root" in done.stdout) == allowed


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in NAMES if name != "6_rig"])  # starts processes
def test_exercises_as_handed_out(name: str, tmp_path: Path) -> None:
    """Nothing is right before work, and what is missing is said in one line of each cell."""
    pytest.importorskip("nbclient")
    script = notebooks()
    notebook = script._notebook(script.exercise((COURSE / f"{name}.md").read_text("utf-8")))
    script._prepare(tmp_path)
    script._run(notebook, tmp_path, allow_errors=True)
    exercises = script.passed(notebook)
    assert len(exercises) >= 3
    assert all(not each.right and each.hint for each in exercises)
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    errors = [output["traceback"] for output in outputs if output.output_type == "error"]
    assert errors
    assert all(len(lines) == 1 and lines[0].startswith("Not yet: ") for lines in errors), errors
    assert not [output for output in outputs if output.get("name") == "stderr"]


# Kinds of wrong answers, made from the right one.
WRONG: dict[str, Any] = {
    "nothing": lambda right: None,
    "a number": lambda right: 0.123,
    "a text": lambda right: "ten",
    "another shape": lambda right: np.zeros((3, 5)),
    "the other sign": lambda right: scaled(right, -1.0),
    "half": lambda right: scaled(right, 0.5),
}


def scaled(right: Any, factor: float) -> Any:
    """An answer whose numbers are multiplied."""
    if isinstance(right, dict):
        return {name: scaled(each, factor) for name, each in right.items()}
    if isinstance(right, tuple | list):
        parts = [scaled(each, factor) for each in right]
        return type(right)(*parts) if hasattr(right, "_fields") else type(right)(parts)
    kept = right is None or isinstance(right, str | bool | set)
    return right if kept else factor * right


def answers_of(source: str) -> list[str]:
    """The names that a cell of a source gives an answer: its function, or its values."""
    before, _, _ = source.partition("# BEGIN SOLUTION")
    if before.endswith("    "):
        return re.findall(r"^def (\w+)", before, re.MULTILINE)[-1:]
    nodes = ast.parse(before).body
    targets = [target for node in nodes if isinstance(node, ast.Assign) for target in node.targets]
    return [node.id for each in targets for node in ast.walk(each) if isinstance(node, ast.Name)]


def hint_of(lab: Any, cell: str, namespace: dict[str, Any], name: str) -> str | None:
    """What the notebook says of the answers that a cell checks; empty if they are right."""
    try:
        exec(compile(cell, name, "exec"), namespace)
    except Exception as error:
        return lab.explanation(error, error.__traceback__)  # type: ignore[no-any-return]
    return ""


LONG = ("3_compensation", "4_identification", "5_tuning", "7_axis")


@pytest.mark.parametrize(
    "name", ["1_model", "2_limit_cycle", *(pytest.param(n, marks=pytest.mark.long) for n in LONG)]
)
def test_each_wrong_answer_has_a_hint(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line that says what is wrong, for each exercise and each kind of wrong answer."""
    monkeypatch.syspath_prepend(COURSE)
    monkeypatch.chdir(tmp_path)
    with monkeypatch.context() as without_jupyter:
        stub: Any = SimpleNamespace(get_ipython=lambda: None)
        without_jupyter.setitem(sys.modules, "IPython", stub)
        lab = importlib.import_module("lab")
    namespace: dict[str, Any] = {"__name__": "notebook"}
    script, answers, tried = notebooks(), list[str](), 0
    for number, source in enumerate(script.code_cells((COURSE / f"{name}.md").read_text("utf-8"))):
        cell, where = script.solution(source), f"cell {number}"
        for kind, make in WRONG.items() if answers and re.search(r"\b(check|need)\(", cell) else ():
            right = {answer: namespace[answer] for answer in answers}
            for answer, each in right.items():
                returns = partial(lambda of, as_, *given: as_(of(*given)), each, make)
                namespace[answer] = returns if callable(each) else make(each)
            hint = hint_of(lab, cell, namespace, where)
            namespace |= right
            assert hint is not None, (where, kind)
            assert hint or kind in ("the other sign", "half"), (where, kind)
            assert "\n" not in hint and len(hint) < 250, hint
            assert not hint or len(re.findall(r"[a-z]{2,}", hint)) > 2, hint
            tried += 1
        if "# BEGIN SOLUTION" in source:
            answers = answers_of(source)
        elif "check(" in cell:
            answers = []
        assert hint_of(lab, cell, namespace, where) == "", where
    assert tried >= 3 * len(WRONG)
    exec(compile("def failing():\n    return 1 / 0", "another cell", "exec"), namespace)
    assert hint_of(lab, "failing()", namespace, "cell") is None  # shown whole


def test_sheet_tells_what_an_exercise_has_shown() -> None:
    """The checks that hold and the first hint, by the heading above them."""

    def cell(kind: str, source: str, *printed: str) -> SimpleNamespace:
        outputs = [{"text": text} for text in printed]
        return SimpleNamespace(cell_type=kind, source=source, outputs=outputs)

    cells = [
        cell("code", "", "Right: this is no exercise.\n"),
        cell("markdown", "text\n### Exercise 1: a\n"),
        cell("code", "", "Right: one.\nRight: two.\n"),
        cell("markdown", "### Exercise 2: b"),
        SimpleNamespace(cell_type="code", source="", outputs=[{"traceback": ["Not yet: look"]}]),
        cell("code", "", "Not yet: x comes from a cell above\n"),
    ]
    first, second = notebooks().passed(SimpleNamespace(cells=cells))
    assert first == ("Exercise 1: a", ["one", "two"], "")
    assert second == ("Exercise 2: b", [], "look")
