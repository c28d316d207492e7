"""``colcon test`` runs the same tests as ``make test``, each once."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from sources import PACKAGES, ROOT, SOURCES, TESTS

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


def behind_links(test: str) -> str:
    """The test with the path of its file, not of a link to it."""
    file, _, name = test.partition("::")
    return f"{(ROOT / file).resolve()}::{name}"


def test_every_test_is_in_one_package() -> None:
    """None is left out, none runs twice, and every package has some."""
    tests = collected([TESTS, *(SOURCES / package for package in PACKAGES)])
    by_package = [each for each in tests if each.startswith("furuta_ws/src/")]
    all_tests = [each for each in tests if each.startswith("furuta_ws/tests/")]
    assert sorted(map(behind_links, by_package)) == sorted(map(behind_links, all_tests))
    assert {each.split("/")[2] for each in by_package} == set(PACKAGES)
