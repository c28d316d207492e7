"""``colcon test`` runs the same tests as ``make test-all``, each once."""

import os
import re
from itertools import chain
from pathlib import Path

from sources import PACKAGES, SOURCES, TESTS


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
