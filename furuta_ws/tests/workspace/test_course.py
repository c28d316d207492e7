"""The notebooks of the course use what the library has. ``make course CHECK=1`` runs them."""

import ast
import importlib.util
import os
import re
import subprocess
from pathlib import Path
from types import ModuleType

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
