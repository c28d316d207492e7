"""Without an optional package: one line that names it and what to install, not a traceback."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytestmark = [pytest.mark.long, pytest.mark.noble]

NOT_INSTALLED = "raise ModuleNotFoundError(f'No module named {__name__!r}', name=__name__)"
UNFIT = "raise ImportError('pyarrow requires NumPy 2.0 or newer, found 1.26.4')"
AXIS = "axis --inertia 1 --friction alpha0=0.1 --pid 40 13 40"
TABLE = "simulate --seconds 1 --out run.parquet"


@pytest.fixture
def replace(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> Callable[[str, str], None]:
    """Put a stand-in with this code before a package, for the processes that the test starts."""

    def stand_in(name: str, code: str) -> None:
        folder = tmp_path_factory.mktemp("packages")
        (folder / f"{name}.py").write_text(code)
        monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder), os.environ["PYTHONPATH"]]))

    return stand_in


@pytest.fixture
def run_there(
    processes: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[str], tuple[int, str, str]]:
    """Run a verb in an empty directory."""
    monkeypatch.chdir(tmp_path)
    return lambda arguments: processes.run(*arguments.split())


@pytest.mark.parametrize(
    ("missing", "arguments", "remedy"),
    [
        ("viser", "view --no-open", "pip install viser"),
        ("distributed", "sweep alpha0=1 --scheduler tcp://127.0.0.1:9", "pip install distributed"),
        ("pyarrow", TABLE, "pip install"),
        ("flint", f"{AXIS} --prove", "pip install python-flint"),
        ("control", "linearize", "pip install control"),
        ("matplotlib", "simulate --seconds 1 --out run.png", "pip install matplotlib"),
        ("ziglang", "hw emulate --firmware", "ziglang"),
        ("rclpy", "run", "ROS 2 Jazzy, or on Linux x86-64 pip install 'furuta[ros]'"),
    ],
)
def test_a_verb(
    replace: Any, run_there: Any, tmp_path: Path, missing: str, arguments: str, remedy: str
) -> None:
    """It ends with status 1 and has written no file."""
    replace(missing, NOT_INSTALLED)
    status, out, err = run_there(arguments)
    assert (status, out) == (1, "")
    (line,) = err.splitlines()
    assert missing in line
    assert remedy in line
    assert "Error" not in line
    assert not any(path.is_file() for path in tmp_path.rglob("*"))


def test_pyarrow_that_does_not_fit_numpy(replace: Any, run_there: Any) -> None:
    """Pip brings one that does not fit the numpy of Ubuntu 24.04."""
    replace("pyarrow", UNFIT)
    status, out, err = run_there(TABLE)
    assert (status, out) == (1, "")
    (line,) = err.splitlines()
    assert "requires NumPy 2.0 or newer, found 1.26.4): pip install" in line


@pytest.mark.parametrize(
    ("missing", "user", "call"),
    [
        ("gymnasium", "furuta.gym", "import furuta.gym"),
        ("flint", "furuta.axis.proof", "import furuta.axis.proof"),
        ("control", "furuta.linearize", "furuta.linearize()"),
    ],
)
def test_the_library(replace: Any, missing: str, user: str, call: str) -> None:
    """Only what needs the package fails, and says so."""
    replace(missing, NOT_INSTALLED)
    script = f"import furuta; furuta.make_loop(); {call}"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert f"ModuleNotFoundError: {user} needs {missing}, which is not installed: pip" in last
