"""The page of the paper's figures says what its commands find today."""

import re

import paper
import pytest
import yaml
from sources import ROOT, manifest

PAGE = paper.PAGE.read_text(encoding="utf-8")
NUMBER = re.compile(r"(?<![\w.])[-−]?\d+(?:\.\d+)?(?![\w⁻])")
# What another version of a library or another processor may change, as a part of the value.
CHANGE = 0.02


def numbers(row: str) -> list[float]:
    """The numbers in the column of what is found here."""
    return [float(each.replace("−", "-")) for each in NUMBER.findall(row.split(" | ")[3])]


@pytest.mark.parametrize("row", paper.ROWS, ids=lambda row: f"{row.place} {row.command[:40]}")
def test_row_is_what_its_command_finds(row: paper.Row) -> None:
    """Text to the letter; numbers to 2 %, or to the last digit that is shown."""
    found = f"| {' | '.join(paper.row_cells(row))} |\n"
    places = [line for line in PAGE.splitlines(keepends=True) if f" `{row.command}` |" in line]
    (line,) = [each for each in places if each.startswith(f"| {row.place} |")]
    assert NUMBER.sub("", line) == NUMBER.sub("", found)
    assert numbers(line) == pytest.approx(numbers(found), rel=CHANGE, abs=2e-3)


def test_citation_has_the_version_and_its_date() -> None:
    """The version is that of the packages."""
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert cited["version"] == manifest("furuta").findtext("version")
    assert cited["date-released"].year >= 2026
