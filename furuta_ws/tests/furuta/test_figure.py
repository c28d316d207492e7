"""Saving, labels and colours of figures."""

from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from furuta.figures.figure import axis_label, legend_outside, saved_figure

PNG = b"\x89PNG"


@pytest.fixture(autouse=True)
def no_figure_of_others() -> None:
    """Other tests run code of pages, which leaves figures open."""
    plt.close("all")


def test_figure_is_saved_and_closed(tmp_path: Path) -> None:
    path = tmp_path / "new" / "figure.png"
    with saved_figure(path, 2, figsize=(2, 2)) as (figure, axes):
        assert plt.get_fignums() == [figure.number]
        axes[1].plot([0, 1])
        assert not path.exists()
    assert path.read_bytes().startswith(PNG)
    assert plt.get_fignums() == []


@pytest.mark.parametrize("place", ["lower center", "upper right"])
def test_a_legend_outside_hides_nothing(tmp_path: Path, place: str) -> None:
    """Neither curves nor titles and labels, and it is on the figure itself."""
    with saved_figure(tmp_path / "figure.png", 2, 2, figsize=(5, 4)) as (figure, axes):
        for axis in axes.flat:
            axis.plot([0, 1], label="curve")
            axis.set(title="title", xlabel="time [s]", ylabel="angle [rad]")
        legend_outside(figure, place, *axes[0, 0].get_legend_handles_labels(), ncols=2)
        figure.canvas.draw()
        (legend,) = figure.legends
        box = legend.get_window_extent()
        drawn = [axis.get_tightbbox() for axis in axes.flat]
        bottom, top = min(each.y0 for each in drawn), max(each.y1 for each in drawn)
        free = bottom - box.y1 if place.startswith("lower") else box.y0 - top
        assert 0.0 <= free < box.height
        assert figure.bbox.y0 <= box.y0 < box.y1 <= figure.bbox.y1


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
