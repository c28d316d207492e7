"""The command line of a clone: called through a symbolic link, and in a path with a space."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

from sources import ROOT

VERB = ("linearize", "--json")


def run(furuta: Path, folder: Path) -> str:
    """Standard output of ``furuta linearize --json``, started in a folder."""
    done = subprocess.run([furuta, *VERB], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_symbolic_link(tmp_path: Path) -> None:
    """A link to ``furuta`` runs it from any folder."""
    link = tmp_path / "furuta"
    link.symlink_to(ROOT / "furuta")
    assert "L" in json.loads(run(link, tmp_path))
