"""The command line of a clone: through a symbolic link, and in a path with a space."""

import shutil
import site
import subprocess
import venv
from pathlib import Path

import pytest
from sources import ROOT, SOURCES

pytestmark = pytest.mark.long

# A workspace with one package, whose command line prints where it is installed.
COMMAND = """
def main() -> None:
    print(__file__)
"""


def run(furuta: Path, folder: Path) -> str:
    """Standard output of a clone's command line, started in a folder."""
    done = subprocess.run(
        [furuta, "linearize"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """A clone in a path with a space: our tools, one package, a virtual environment of its own."""
    root = tmp_path / "my clone"
    package = root / "furuta_ws" / "src" / "furuta_bringup"
    package.mkdir(parents=True)
    shutil.copytree(ROOT / "tools", root / "tools")
    shutil.copy(ROOT / "furuta", root)
    for name in ("package.xml", "setup.cfg", "setup.py", "resource"):
        source = SOURCES / "furuta_bringup" / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, package / name)
    (package / "furuta_bringup").mkdir()
    (package / "furuta_bringup" / "__init__.py").touch()
    (package / "furuta_bringup" / "main.py").write_text(COMMAND)
    (package / "furuta_bringup" / "warm_up.py").touch()
    make_environment(root)
    return root


def make_environment(root: Path) -> None:
    """A virtual environment with the packages of this one, as tools/in_environment makes it."""
    venv.create(root / ".venv", symlinks=True)
    (packages,) = (root / ".venv" / "lib").glob("*/site-packages")
    (packages / "shared.pth").write_text("\n".join(site.getsitepackages()))
    colcon = root / ".venv" / "bin" / "colcon"
    colcon.write_text('#!/bin/sh\nexec "$(dirname "$0")/python" -m colcon "$@"\n')
    colcon.chmod(0o755)
    for folder in (root, root / ".venv"):
        shutil.copy(ROOT / "requirements.lock", folder)


def test_path_with_a_space(clone: Path, tmp_path: Path) -> None:
    """The workspace builds, and its executables find the environment's Python."""
    assert run(clone / "furuta", tmp_path).startswith(f"{clone}/furuta_ws/install/")


def test_symbolic_link(clone: Path, tmp_path: Path) -> None:
    """A link to ``furuta`` runs the clone's command line from any folder."""
    link = tmp_path / "furuta"
    link.symlink_to(clone / "furuta")
    assert run(link, tmp_path) == run(clone / "furuta", tmp_path)
