"""Saving, labels and colours of figures."""

from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from furuta.figures.figure import mark_half_turns, saved_figure
from furuta.figures.labels import axis_label

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


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("omega1", "ω₁ [rad/s]"),
        ("zeta1", "ζ₁"),
        ("viscous", "σ₂ [V s/rad]"),
        ("plant.friction.alpha0", "α₀ of plant.friction [V]"),
        ("adaptation_gain", "adaptation_gain"),
        ("l2", "l₂ [V s/rad]"),
    ],
)
def test_axis_labels(name: str, label: str) -> None:
    """Symbol and declared unit; a name that restricts the parameter stays."""
    assert axis_label(name).startswith(label)


@pytest.mark.parametrize(
    ("limits", "marks"),
    [
        ((-0.1, 3.2), {"0", "π/2", "π"}),
        ((-6.4, 6.4), {"−2π", "−π", "0", "π", "2π"}),
        ((-3.2, 0.0), {"−π", "−π/2", "0"}),
    ],
)
def test_half_turns_are_marked(limits: tuple[float, float], marks: set[str]) -> None:
    """Multiples of π on the axis of an angle that turns over; a small angle keeps its numbers."""
    figure, (large, small) = plt.subplots(1, 2)
    large.set_ylim(*limits)
    small.set_ylim(-0.2, 0.2)
    for axis in (large, small):
        mark_half_turns(axis)
    figure.canvas.draw()
    assert marks <= {text.get_text() for text in large.get_yticklabels()}
    assert not any("π" in text.get_text() for text in small.get_yticklabels())
    plt.close(figure)
