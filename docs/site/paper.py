"""Writes the table of docs/paper.md anew: ``python docs/site/paper.py``.

Each row of ``paper.yaml`` has a command of ``furuta``, and a text with numbers of its JSON. The
rest of the page stays, and with it the command that makes the recording of one row.
"""

import json
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import yaml
from results import ROOT, renewed

PAGE = ROOT / "docs" / "paper.md"
HEADING = "Figures and numbers"
# A recording that the command of a row needs.
RECORDING = "hanging.csv"
# What JSON and Python write, as a reader expects it.
WORDS = {"-": "−", "±−": "±", "e−04": "·10⁻⁴", "False": "no", "True": "yes"}


class Row(NamedTuple):
    """What the paper shows at a place, and the command whose JSON fills the text ``here``."""

    place: str
    paper: str
    command: str
    here: str
    difference: str


ROWS = [Row(*row) for row in yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())]


def result_of(command: str, folder: Path) -> dict[str, Any]:
    """What a command prints with ``--json``, or the parameters of a file that it prints."""
    is_file = command.startswith("param")
    words = [str(ROOT / "furuta"), *command.split(), *([] if is_file else ["--json"])]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    if not done.stdout:
        raise RuntimeError(done.stderr)
    found: dict[str, Any] = yaml.safe_load(done.stdout) if is_file else json.loads(done.stdout)
    return found["plant"]["ros__parameters"] if is_file else found


def row_cells(row: Row) -> list[str]:
    """A row of the table, computed."""
    with tempfile.TemporaryDirectory() as folder:
        if RECORDING in row.command:
            (made,) = re.findall(r"^    \./furuta ((?:.*\\\n)*.*)", PAGE.read_text(), re.MULTILINE)
            result_of(made.replace("\\\n", ""), Path(folder))
        here = row.here.format_map(result_of(row.command, Path(folder)))
    for written, read in WORDS.items():
        here = here.replace(written, read)
    return [row.place, row.paper, f"`{row.command}`", here, row.difference]


if __name__ == "__main__":
    PAGE.write_text(renewed(PAGE.read_text(), HEADING, map(row_cells, ROWS)), encoding="utf-8")
