"""Types of options: what they accept, and the reason when they do not."""

from __future__ import annotations

from pathlib import Path

import click
import pytest

from furuta_bringup.file_types import FIGURE
from furuta_bringup.number_types import FiniteRange, NonZero

POSITIVE = FiniteRange(min=0, min_open=True)


@pytest.mark.parametrize("text", ["nan", "inf", "0", "-1", "two"])
def test_range_rejects(text: str) -> None:
    """Numbers outside the range, and what is no finite number."""
    with pytest.raises(click.BadParameter, match=text):
        POSITIVE.convert(text, None, None)


@pytest.mark.parametrize("text", ["0", "-0.0", "nan", "-inf"])
def test_nonzero_rejects(text: str) -> None:
    """Zero of either sign, and what is no finite number."""
    with pytest.raises(click.BadParameter, match=f"{text} is not a finite number other than 0"):
        NonZero().convert(text, None, None)


def test_numbers_are_accepted() -> None:
    """As numbers."""
    assert POSITIVE.convert("1e-3", None, None) == 1e-3
    assert NonZero().convert("-2", None, None) == -2.0


def test_figure_needs_a_known_suffix(tmp_path: Path) -> None:
    """In either case; anything else is rejected with the suffixes that are known."""
    assert FIGURE.convert(str(tmp_path / "a.PNG"), None, None) == tmp_path / "a.PNG"
    with pytest.raises(click.BadParameter, match=r"a\.txt does not end in \.png, \.pdf"):
        FIGURE.convert(str(tmp_path / "a.txt"), None, None)
