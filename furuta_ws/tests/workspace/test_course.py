"""The lab course: its notebooks are consistent, and the first one accepts only right answers.

``make course CHECK=1`` runs the solutions of all notebooks.
"""

import ast
import importlib.util
import os
import re
import subprocess
import sys
from types import ModuleType

import pytest
from sources import ROOT

import furuta

COURSE = ROOT / "course"
NAMES = sorted(path.stem for path in COURSE.glob("[1-9]_*.md"))
EMPTY = 'raise NotImplementedError("your code here")'
# For each exercise of the first notebook answers that are plausible and wrong.
WRONG = {
    "accelerations": [
        "def accelerations(x, torque):\n    return np.zeros(2)",
        "def accelerations(x, torque):\n    return right_answer(x, torque) + [0, x[1] * x[3]]",
        "def accelerations(x, torque):\n    return right_answer(x, 1.1 * torque)",
        "def accelerations(x, torque):\n    return right_answer(x, -torque)",
    ],
    "linearised": [
        "def linearised():\n    a, b = right_answer()\n    return a.T, b",
        "def linearised():\n    a, b = right_answer()\n    return a, -b",
    ],
    "pendulum_of": ["def pendulum_of(*given):\n    return pendulum"],
    "gain": ["def gain(a, b, polynomial):\n    return -right_answer(a, b, polynomial)"],
    "largest": ["largest = 0.05", "largest = 1.5", "largest = None"],
}


def notebooks() -> ModuleType:
    """The script that makes the notebooks."""
    spec = importlib.util.spec_from_file_location("notebooks", COURSE / "notebooks.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def source(name: str) -> str:
    return (COURSE / f"{name}.md").read_text(encoding="utf-8")


def cells(name: str) -> list[tuple[str, str]]:
    """Each cell of a notebook as exercise and as solution."""
    script, text = notebooks(), source(name)
    given, solved = (script.code_cells(each(text)) for each in (script.exercise, script.solution))
    return list(zip(given, solved, strict=True))


@pytest.mark.parametrize("name", NAMES)
def test_exercises_are_the_solutions_without_the_answers(name: str) -> None:
    """Other cells are the same; each exercise is followed by its check; no mark is left."""
    script, both = notebooks(), cells(name)
    exercises = [k for k, (given, solved) in enumerate(both) if given != solved]
    assert 3 <= len(exercises) <= 5
    for k in exercises:
        assert both[k][0].count(EMPTY) == 1
        assert "check(" in both[k + 1][1]
    for version in (script.exercise(source(name)), script.solution(source(name))):
        assert "SOLUTION" not in version
    assert sum("check(" in solved for _, solved in both) >= len(exercises)


@pytest.mark.parametrize("name", NAMES)
def test_code_uses_what_the_library_has(name: str) -> None:
    """Every cell is valid Python, and every name of the library exists."""
    module = "library" if "import furuta as library" in source(name) else "furuta"
    for each in cells(name):
        for code in each:
            ast.parse(code)
            used = set(re.findall(rf"\b{module}\.(\w+)", code))
            assert used <= set(furuta.__all__), used


@pytest.mark.long
def test_first_notebook_accepts_right_answers_only() -> None:
    """Its solution passes all checks, and each wrong answer gets a hint."""
    both, script, tried = cells("1_model"), ["from lab import NotYetError"], 0
    for k, (given, solved) in enumerate(both):
        if given == solved:
            script.append(solved)
            continue
        (answer,) = (name for name in WRONG if re.search(rf"^(def )?{name}\b", solved, re.M))
        script += [solved, f"right_answer = {answer}"]
        for wrong in WRONG[answer]:
            lines = (wrong + "\n" + both[k + 1][1]).splitlines()
            body = "\n".join("    " + line for line in lines)
            script.append(
                f"try:\n{body}\nexcept NotYetError as hint:\n    print('Hint:', hint)\n"
                f"else:\n    raise SystemExit({f'accepted: {wrong}'!r})"
            )
            tried += 1
        script.append(f"{answer} = right_answer")
    done = subprocess.run(
        [sys.executable, "-c", "\n\n".join(script)],
        env={**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": _path()},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("Hint: ") == tried
    assert done.stdout.count("Right: ") >= 10


def _path() -> str:
    return os.pathsep.join([str(COURSE), os.environ.get("PYTHONPATH", "")])
