"""Saving, labels and colours of figures."""

from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from furuta.figures.figure import saved_figure
from furuta.figures.labels import axis_label

PNG = b"\x89PNG"


def test_figure_is_saved_and_closed(tmp_path: Path) -> None:
    path = tmp_path / "new" / "figure.png"
    with saved_figure(path, 2, figsize=(2, 2)) as (figure, axes):
        assert plt.get_fignums() == [figure.number]
        axes[1].plot([0, 1])
        assert not path.exists()
    assert path.read_bytes().startswith(PNG)
    assert plt.get_fignums() == []


def test_nothing_is_saved_after_an_error(tmp_path: Path) -> None:
    path = tmp_path / "figure.png"
    with pytest.raises(ZeroDivisionError), saved_figure(path):
        raise ZeroDivisionError
    assert not path.exists()
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("omega1", "ω₁ [rad/s]"),
        ("plant.friction.alpha0", "α₀ of plant.friction [V]"),
        ("adaptation_gain", "adaptation_gain"),
        ("l2", "l₂ [V s/rad]"),
    ],
)
def test_axis_labels(name: str, label: str) -> None:
    """Symbol and declared unit; a name that restricts the parameter stays."""
    assert axis_label(name).startswith(label)
