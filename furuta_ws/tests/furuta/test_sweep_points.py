"""The points of a sweep."""

import numpy as np
import pytest

from furuta.studies.sweep import Sweep, SweptParameter, parse_swept_parameter
from furuta_model.parameters import ParameterError

ALPHA = SweptParameter("friction_observer.alpha0", (0.1, 0.2, 0.3), False)
KIND = SweptParameter("compensation", ("coulomb", "lugre"), True)


def test_swept_parameters_are_parsed() -> None:
    """Ranges of numbers, integers for integer parameters, and lists of anything."""
    assert parse_swept_parameter("alpha0=0.1:0.3:3", 9).values == pytest.approx((0.1, 0.2, 0.3))
    assert parse_swept_parameter("alpha0=0.1:0.3", 9).values[4] == pytest.approx(0.2)
    assert parse_swept_parameter("plant.seed=0:4:5", 9).values == (0, 1, 2, 3, 4)
    assert parse_swept_parameter("compensation=coulomb,lugre", 9) == KIND


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
def test_bad_swept_parameters_are_rejected(text: str, reason: str) -> None:
    """The error says what is wrong."""
    with pytest.raises(ParameterError, match=reason):
        parse_swept_parameter(text, 5)


def sweep(axes: tuple[SweptParameter, ...], method: str, points: int = 0, seed: int = 0) -> Sweep:
    """A sweep over ``axes``."""
    return Sweep({}, axes, method, points, seed, 1.0)


def test_grid_is_every_combination() -> None:
    """In the order of the parameters; the last one changes fastest."""
    grid = sweep((ALPHA, KIND), "grid")
    points = list(grid.generate_points())
    assert len(points) == grid.size() == 6
    assert points[:3] == [
        {ALPHA.name: 0.1, "compensation": "coulomb"},
        {ALPHA.name: 0.1, "compensation": "lugre"},
        {ALPHA.name: 0.2, "compensation": "coulomb"},
    ]


def test_points_fill_the_range() -> None:
    """Points depend on the seed alone, reach every value, and are even."""
    axes = (ALPHA, KIND, SweptParameter("plant.seed", (0, 9), False))
    points = list(sweep(axes, "sobol", 128, 3).generate_points())
    assert points == list(sweep(axes, "sobol", 128, 3).generate_points())
    assert points != list(sweep(axes, "sobol", 128, 4).generate_points())
    values = np.array([point[ALPHA.name] for point in points])
    assert {point["compensation"] for point in points} == {"coulomb", "lugre"}
    assert {point["plant.seed"] for point in points} == set(range(10))
    assert np.abs(np.sort(values) - np.linspace(0.1, 0.3, 128)).max() / 0.2 < 0.01


def test_sobol_sequence_can_be_extended() -> None:
    """A longer sweep begins with the points of a shorter one, up to the same power of two."""
    longer = list(sweep((ALPHA,), "sobol", 100).generate_points())
    assert longer[:70] == list(sweep((ALPHA,), "sobol", 70).generate_points())


@pytest.mark.parametrize(
    ("axes", "points", "reason"),
    [((ALPHA,), 0, "1 to"), ((ALPHA,), 10**9, "1 to"), ((ALPHA, ALPHA), 5, "once")],
)
def test_impossible_sweeps_are_rejected(
    axes: tuple[SweptParameter, ...], points: int, reason: str
) -> None:
    with pytest.raises(ParameterError, match=reason):
        sweep(axes, "sobol", points).size()
