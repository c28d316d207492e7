"""The cache of compiled functions: used when nothing changed, never stale."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from furuta_model.compiled import KEPT_CACHES, NOTICE, compiled, for_types_of

CONSTANT = "SHIFT = 1.0"
CALLEE = """
from furuta_model.compiled import compiled
@compiled
def callee(x):
    return 2.0 * x
"""
CALLER = """
from furuta_model.compiled import compiled
from callee_module import callee
from constant_module import SHIFT
@compiled
def middle(x):
    return callee(x) + SHIFT
@compiled
def caller(x):
    return middle(x)
"""
GROUP = """
from typing import NamedTuple
class Group(NamedTuple):
    {}: float
    {}: float
"""
READER = """
from callee_module import Group
from furuta_model.compiled import compiled
@compiled
def caller(group: Group):
    return group.low
"""
SCRIPT = """
from caller_module import caller
print(caller(3.0), sum(caller.stats.cache_hits.values()))
"""


def write(folder: Path, **modules: str) -> None:
    for name, text in modules.items():
        (folder / f"{name}_module.py").write_text(text)


def run(folder: Path, script: str = SCRIPT) -> tuple[float, int]:
    """Result and number of cache hits of the script in a new interpreter."""
    kept = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    python_path = os.pathsep.join([str(folder), kept.get("PYTHONPATH", "")])
    # Python's own cache cannot distinguish edits of equal length within a second.
    kept |= {"PYTHONPATH": python_path, "PYTHONDONTWRITEBYTECODE": "1"}
    result, hits = done_by(script, kept).stdout.split()
    return float(result), int(hits)


def done_by(script: str, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """What a new interpreter prints that runs a script."""
    start = [sys.executable, "-c", script]
    return subprocess.run(start, env=environment, capture_output=True, text=True, check=True)


def test_cache_is_used_and_never_stale(tmp_path: Path) -> None:
    """A second run is a hit; an edit of an indirect callee or of a constant is not."""
    write(tmp_path, constant=CONSTANT, callee=CALLEE, caller=CALLER)
    assert run(tmp_path) == (7.0, 0)
    assert run(tmp_path) == (7.0, 1)
    write(tmp_path, callee=CALLEE.replace("2.0 * x", "5.0 * x"))
    assert run(tmp_path) == (16.0, 0)
    write(tmp_path, constant="SHIFT = 9.0")
    assert run(tmp_path) == (24.0, 0)


VALUES = {"TABLE": "((1.0, 2.0), (3.0,))", "NAME": "'plus'", "ARRAY": "np.array([[4.0, 5.0]])"}
TAKER = """
import values_module
from furuta_model.compiled import compiled
from values_module import ARRAY, NAME, TABLE
@compiled
def caller(x):
    more = values_module.deeper_module.SHIFT
    return (x if NAME == "plus" else -x) + TABLE[1][0] + ARRAY[0, 1] + more
"""


def test_values_of_other_files_are_part_of_the_key(tmp_path: Path) -> None:
    """A tuple in a tuple, a text, an array and a number of a module's module."""

    def result(shift: float = 0.0, **changed: str) -> float:
        """What the function gives after an edit of the other files."""
        lines = [f"{name} = {value}" for name, value in (VALUES | changed).items()]
        write(tmp_path, values="\n".join(["import deeper_module", "import numpy as np", *lines]))
        write(tmp_path, deeper=f"SHIFT = {shift}")
        found, hits = run(tmp_path)
        assert hits == 0
        return found

    write(tmp_path, caller=TAKER)
    assert result() == 11.0
    assert result(TABLE="((1.0, 2.0), (30.0,))") == 38.0
    assert result(NAME="'minus'") == 5.0
    assert result(ARRAY="np.array([[4.0, 50.0]])") == 56.0
    assert result(100.0) == 111.0


PACKAGE_CALLER = """
from furuta_low.deep.callee_module import callee
from furuta_model.compiled import compiled
@compiled
def caller(x):
    return callee(x)
"""


def test_key_of_a_package_has_the_packages_that_it_imports(tmp_path: Path) -> None:
    """With all their sources; an edit of a package that it does not import is a hit."""
    for package in ("furuta_low", "furuta_low/deep", "furuta_high", "furuta_other"):
        (tmp_path / package).mkdir()
        (tmp_path / package / "__init__.py").touch()
    write(tmp_path / "furuta_low" / "deep", callee=CALLEE)
    write(tmp_path / "furuta_high", caller=PACKAGE_CALLER)
    script = SCRIPT.replace("caller_module", "furuta_high.caller_module")
    assert run(tmp_path, script) == (6.0, 0)
    write(tmp_path / "furuta_other", constant=CONSTANT)
    assert run(tmp_path, script) == (6.0, 1)
    write(tmp_path / "furuta_low" / "deep", callee=CALLEE.replace("2.0 * x", "5.0 * x"))
    assert run(tmp_path, script) == (15.0, 0)


def test_old_caches_are_removed(tmp_path: Path) -> None:
    """Those of the newest contents of a package remain."""
    cache = tmp_path / "__pycache__" / "furuta"
    for number in range(KEPT_CACHES + 2):
        (cache / f"{tmp_path.name}-{number}" / "deep").mkdir(parents=True)
        os.utime(cache / f"{tmp_path.name}-{number}", (number, number))
    (cache / "other-0").mkdir()
    write(tmp_path, constant=CONSTANT, callee=CALLEE, caller=CALLER)
    assert run(tmp_path) == (7.0, 0)
    assert run(tmp_path) == (7.0, 1)
    assert len(list(cache.glob(f"{tmp_path.name}-*"))) == KEPT_CACHES
    assert (cache / f"{tmp_path.name}-{KEPT_CACHES + 1}").exists()
    assert (cache / "other-0").exists()


@compiled
def total_of(values: Any) -> float:
    """The sum of all numbers."""
    return np.sum(np.array(values)) if isinstance(values, tuple) else np.sum(values)


@pytest.mark.parametrize(
    "others",
    [
        (np.ones(3), np.ones((3, 2))),
        (np.ones((4, 4)), np.ones((4, 4))[:, :2]),
        ((1.0, 2.0), (1.0, 2.0, 3.0)),
    ],
    ids=["dimensions", "strides", "length"],
)
def test_machine_code_is_that_of_the_arguments_types(others: tuple[Any, Any]) -> None:
    """Arrays differ by their dimensions and how they lie in memory, tuples by their length."""
    for given in others:
        assert for_types_of(total_of, given)(given) == np.sum(given)


def test_order_of_an_arguments_fields(tmp_path: Path) -> None:
    """Swapping two fields of a parameter tuple in another module does not swap their values."""
    script = "from callee_module import Group\n" + SCRIPT.replace("3.0", "Group(low=1.0, high=2.0)")
    write(tmp_path, callee=GROUP.format("low", "high"), caller=READER)
    assert run(tmp_path, script) == (1.0, 0)
    write(tmp_path, callee=GROUP.format("high", "low"))
    assert run(tmp_path, script)[0] == 1.0


NOTICED = """
import furuta_model.compiled
furuta_model.compiled.UNNOTICED = {}
from caller_module import caller
print(caller(3.0))
"""


def errors_of(folder: Path, script: str) -> list[str]:
    """The lines on standard error of the script; standard output is the result alone."""
    path = os.pathsep.join([str(folder), os.environ["PYTHONPATH"]])
    environment = os.environ | {"PYTHONPATH": path, "NUMBA_CACHE_DIR": str(folder / "cache")}
    done = done_by(script, environment)
    assert done.stdout == "7.0\n"
    return done.stderr.splitlines()


def test_compilation_is_announced(tmp_path: Path) -> None:
    """In one line on standard error, if it takes long, and not where the code is in the cache."""
    write(tmp_path, constant=CONSTANT, callee=CALLEE, caller=CALLER)
    assert errors_of(tmp_path, NOTICED.format(0.0)) == [NOTICE]
    assert errors_of(tmp_path, NOTICED.format(0.0)) == []
    write(tmp_path, callee=CALLEE.replace("2.0 * x", "x + x"))
    assert errors_of(tmp_path, NOTICED.format(60.0)) == []
