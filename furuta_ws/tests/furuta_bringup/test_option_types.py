"""Types of options: what they accept, and the reason when they do not."""

from pathlib import Path

import click
import pytest

from furuta_bringup.file_types import FIGURE
from furuta_bringup.number_types import FiniteRange, NonZero

POSITIVE = FiniteRange(min=0, min_open=True)


def test_numbers() -> None:
    """Those of the range; of the other type all but zero of either sign. Both must be finite."""
    assert POSITIVE.convert("1e-3", None, None) == 1e-3
    assert NonZero().convert("-2", None, None) == -2.0
    for kind, texts in (
        (POSITIVE, ("nan", "inf", "0", "-1")),
        (NonZero(), ("-0.0", "nan", "-inf")),
    ):
        for text in texts:
            with pytest.raises(click.BadParameter, match=text):
                kind.convert(text, None, None)


def test_figure_needs_a_known_suffix(tmp_path: Path) -> None:
    """In either case; anything else is rejected with the suffixes that are known."""
    assert FIGURE.convert(str(tmp_path / "a.PNG"), None, None) == tmp_path / "a.PNG"
    with pytest.raises(click.BadParameter, match=r"a\.txt does not end in \.png, \.pdf"):
        FIGURE.convert(str(tmp_path / "a.txt"), None, None)
