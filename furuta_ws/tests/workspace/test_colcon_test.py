"""``colcon test`` runs the same tests as ``make test``, each once."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from itertools import chain
from pathlib import Path

from sources import PACKAGES, ROOT, SOURCES, TESTS

# A package with few tests.
PACKAGE = "furuta_description"
# colcon passes options for its own run of pytest, such as the file for its results.
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTEST_ADDOPTS"}


def collected(folders: list[Path]) -> list[str]:
    """The tests that pytest finds in these folders, each with its path in the repository."""
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "--collect-only", "--quiet", *map(str, folders)],
        cwd=ROOT,
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        check=True,
    )
    return [line for line in done.stdout.splitlines() if "::" in line]


def files_of(folder: Path) -> list[Path]:
    """The files of tests in a folder, behind all links."""
    found = [
        Path(at) / name for at, _, names in os.walk(folder, followlinks=True) for name in names
    ]
    return [file.resolve() for file in found if re.fullmatch(r"test_\w+\.py", file.name)]


def test_every_test_is_in_one_package() -> None:
    """None is left out, none runs twice, and every package has some."""
    by_package = {package: files_of(SOURCES / package) for package in PACKAGES}
    assert all(by_package.values())
    assert sorted(chain(*by_package.values())) == sorted(files_of(TESTS))


def test_pytest_follows_the_links() -> None:
    """It finds the same tests in a package as in the folder of its tests."""
    in_package = collected([SOURCES / PACKAGE])
    ends = [test.rpartition("/")[2] for test in collected([TESTS / PACKAGE])]
    assert [test.rpartition("/")[2] for test in in_package] == ends != []
