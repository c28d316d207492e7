"""The page on the library lists what there is; the Python of every page runs."""

import re
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import commands
import pytest
from sources import ROOT

import furuta
import furuta.results

LIBRARY = ROOT / "docs" / "library.md"
# A block of Python with the comments above it. One with a title is a file of its own.
BLOCK = re.compile(r"((?:^<!-- .* -->\n+)*)^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
PAGES = [file for file in commands.page_files() if "```python\n" in file.read_text()]


def test_library_page_has_every_name() -> None:
    """And names nothing else."""
    listed = re.search(r"## What there is\n(.*?)\n## ", LIBRARY.read_text(), re.DOTALL)
    assert listed is not None
    tables, _, _ = listed[1].partition("Every result")
    names = {*furuta.__all__, *furuta.results.__all__} - {"Result"}
    assert {*re.findall(r"`(\w+)`", tables)} == names
    assert len(furuta.__all__) <= 45
    assert set(re.findall(r"furuta\.(\w+)", LIBRARY.read_text())) <= {"gym", *dir(furuta)}


def blocks(page: Path) -> list[str]:
    """The blocks of a page that can run here: no note and no file of another rig forbids it."""
    found = [(code, tuple(commands.NOTE.findall(n))) for n, code in BLOCK.findall(page.read_text())]
    usable = [code for code, notes in found if not commands.reason_not_to_run(code, notes)]
    missing = [name for name in ("gymnasium", "pandas", "xarray") if find_spec(name) is None]
    return [code for code in usable if not any(name in code for name in missing)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_python_of_a_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Block after block, as a reader types them; with shorter simulations."""
    monkeypatch.chdir(tmp_path)
    furuta.simulate(seconds=0.1).write("run.csv")
    names: dict[str, Any] = {}
    for code in blocks(page):
        short = re.sub(r"\b[36]0\.0\b", "5.0", code).replace("rigs(100", "rigs(2")
        exec(compile(short, page.name, "exec"), names)
    if not names:
        pytest.skip("the page needs a package that is not installed")
