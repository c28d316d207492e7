"""Saving of figures."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from furuta_figures.figure import saved_figure

PNG = b"\x89PNG"


def test_figure_is_saved_and_closed(tmp_path: Path) -> None:
    """The directory is created, and no figure stays open."""
    path = tmp_path / "new" / "figure.png"
    with saved_figure(path, 2, figsize=(2, 2)) as (figure, axes):
        assert plt.get_fignums() == [figure.number]
        axes[1].plot([0, 1])
        assert not path.exists()
    assert path.read_bytes().startswith(PNG)
    assert plt.get_fignums() == []


def test_nothing_is_saved_after_an_error(tmp_path: Path) -> None:
    """An exception leaves neither a file nor an open figure."""
    path = tmp_path / "figure.png"
    with pytest.raises(ZeroDivisionError), saved_figure(path):
        raise ZeroDivisionError
    assert not path.exists()
    assert plt.get_fignums() == []
