"""Which points a study has."""

from __future__ import annotations

import numpy as np
import pytest

from furuta_model.parameters import ParameterError
from furuta_studies.sweep_points import Axis, design, parse_axis, size_of

ALPHA = Axis("friction_observer.alpha0", (0.1, 0.2, 0.3), False)
KIND = Axis("compensation", ("coulomb", "lugre"), True)


def test_axes() -> None:
    """Ranges of numbers, whole ones for whole parameters, and lists of anything."""
    assert parse_axis("alpha0=0.1:0.3:3", 9).values == pytest.approx((0.1, 0.2, 0.3))
    assert parse_axis("alpha0=0.1:0.3", 9).values[4] == pytest.approx(0.2)
    assert parse_axis("plant.seed=0:4:5", 9).values == (0, 1, 2, 3, 4)
    assert parse_axis("compensation=coulomb,lugre", 9) == KIND


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("alpha0", "expected NAME="),
        ("alpha0=", "expected NAME="),
        ("alpho0=1:2", "no parameter alpho0"),
        ("alpha0=2:1", "LOW < HIGH"),
        ("alpha0=0:1:1", "COUNT"),
        ("compensation=0:1", "has no range"),
    ],
)
def test_bad_axes_are_refused(text: str, reason: str) -> None:
    """With what is wrong."""
    with pytest.raises(ParameterError, match=reason):
        parse_axis(text, 5)


def test_grid_is_every_combination() -> None:
    """In the order of the axes, the last one fastest."""
    points = list(design((ALPHA, KIND), "grid", 999, 0))
    assert len(points) == size_of((ALPHA, KIND), "grid", 999) == 6
    assert points[:3] == [
        {ALPHA.name: 0.1, "compensation": "coulomb"},
        {ALPHA.name: 0.1, "compensation": "lugre"},
        {ALPHA.name: 0.2, "compensation": "coulomb"},
    ]


@pytest.mark.parametrize("method", ["random", "sobol"])
def test_points_fill_the_range(method: str) -> None:
    """Within it, repeatable by seed, every choice taken; Sobol's spread far more evenly."""
    axes = (ALPHA, KIND, Axis("plant.seed", (0, 9), False))
    points = list(design(axes, method, 128, 3))
    assert points == list(design(axes, method, 128, 3))
    assert points != list(design(axes, method, 128, 4))
    values = np.array([point[ALPHA.name] for point in points])
    assert 0.1 <= values.min() < 0.12
    assert 0.28 < values.max() <= 0.3
    assert {point["compensation"] for point in points} == {"coulomb", "lugre"}
    assert {point["plant.seed"] for point in points} == set(range(10))
    worst = np.abs(np.sort(values) - np.linspace(0.1, 0.3, 128)).max() / 0.2
    assert worst < 0.01 if method == "sobol" else 0.01 < worst < 0.2


def test_sobol_goes_on() -> None:
    """A longer study begins with the points of a shorter one of the same power of two."""
    longer = list(design((ALPHA,), "sobol", 100, 0))
    assert longer[:70] == list(design((ALPHA,), "sobol", 70, 0))


@pytest.mark.parametrize("points", [0, -1, 10**9])
def test_sizes_out_of_range_are_refused(points: int) -> None:
    """No points, and more than a machine can name."""
    with pytest.raises(ParameterError, match="1 to"):
        size_of((ALPHA,), "random", points)
    with pytest.raises(ParameterError, match="once"):
        size_of((ALPHA, ALPHA), "grid", 5)
