"""The notebooks of the course use what the library has. ``make course CHECK=1`` runs them."""

import ast
import importlib.util
import os
import re
import subprocess
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
from sources import ROOT

import furuta

COURSE = ROOT / "course"
NAMES = sorted(path.stem for path in COURSE.glob("[1-9]_*.md"))


def notebooks() -> ModuleType:
    """The script that makes the notebooks."""
    spec = importlib.util.spec_from_file_location("notebooks", COURSE / "notebooks.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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
