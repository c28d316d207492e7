"""Without an optional package: one line that names it and what to install, not a traceback."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytestmark = [pytest.mark.long, pytest.mark.noble]

NOT_INSTALLED = "raise ModuleNotFoundError(f'No module named {__name__!r}', name=__name__)"


@pytest.fixture
def remove(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> Callable[[str], None]:
    """Put a stand-in before a package, for the processes that the test starts."""

    def stand_in(name: str) -> None:
        folder = tmp_path_factory.mktemp("packages")
        (folder / f"{name}.py").write_text(NOT_INSTALLED)
        monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder), os.environ["PYTHONPATH"]]))

    return stand_in


@pytest.mark.parametrize(
    ("missing", "arguments", "remedy"),
    [
        ("websockets", "view --no-open", "pip install websockets"),
        ("pyarrow", "simulate --seconds 1 --out run.parquet", "pip install"),
        ("matplotlib", "simulate --seconds 1 --figure run.png", "pip install matplotlib"),
        ("ziglang", "hw emulate --firmware", "ziglang"),
        ("rclpy", "run", "ROS 2 Jazzy, or on Linux x86-64 pip install '.[ros]'"),
    ],
)
def test_a_verb(
    *, remove: Any, processes: Any, tmp_path: Path, monkeypatch: Any, missing: str, arguments: str,
    remedy: str,
) -> None:  # fmt: skip
    """It ends with status 1 and has written no file; an answer is not lost."""
    monkeypatch.chdir(tmp_path)
    remove(missing)
    status, out, err = processes.run(*arguments.split())
    assert status == 1
    assert out.startswith("The arm") if "simulate" in arguments else out == ""
    (line,) = err.splitlines()
    assert missing in line
    assert remedy in line
    assert "Error" not in line
    assert not any(path.is_file() for path in tmp_path.rglob("*"))


@pytest.mark.parametrize(
    ("module", "entry", "needed"),
    [
        ("rclpy.experimental", "furuta_bringup.main:main", r"rclpy 7\.1\.4 of April 2025 or newer"),
        ("rclpy.experimental", "furuta_control.controller_node:main", r"rclpy 7\.1\.4"),
        ("websockets.asyncio.server", "furuta_bringup.main:main", "a newer websockets: pip"),
    ],
)
def test_an_old_package(module: str, entry: str, needed: str) -> None:
    """It lacks a module: it is called old, not missing."""
    script = (
        f"import sys; sys.modules[{module!r}] = None; sys.argv[1:] = ['view', '--attach']; "
        f"from furuta_ros.process import run_entry; run_entry({entry!r})"
    )
    start = [sys.executable, "-c", script]
    done = subprocess.run(start, capture_output=True, text=True, check=False)
    (line,) = done.stderr.splitlines()
    assert done.returncode == 1
    assert re.match(f"error: .* needs {needed}", line)


def test_the_library(remove: Any) -> None:
    """Only what needs the package fails, and says so."""
    remove("control")
    script = "import furuta; furuta.make_loop(); furuta.linearize()"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert "furuta.linearize needs control, which is not installed: pip" in last
