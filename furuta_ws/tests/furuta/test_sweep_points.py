"""The points of a sweep."""

import numpy as np
import pytest

from furuta.studies.sweep_points import (
    SweptParameter,
    count_points,
    generate_points,
    parse_swept_parameter,
)
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


def test_grid_is_every_combination() -> None:
    """In the order of the parameters; the last one changes fastest."""
    points = list(generate_points((ALPHA, KIND), "grid", 999, 0))
    assert len(points) == count_points((ALPHA, KIND), "grid", 999) == 6
    assert points[:3] == [
        {ALPHA.name: 0.1, "compensation": "coulomb"},
        {ALPHA.name: 0.1, "compensation": "lugre"},
        {ALPHA.name: 0.2, "compensation": "coulomb"},
    ]


@pytest.mark.parametrize("method", ["random", "sobol"])
def test_points_fill_the_range(method: str) -> None:
    """Points depend on the seed alone and reach every value; a Sobol sequence is far more even."""
    axes = (ALPHA, KIND, SweptParameter("plant.seed", (0, 9), False))
    points = list(generate_points(axes, method, 128, 3))
    assert points == list(generate_points(axes, method, 128, 3))
    assert points != list(generate_points(axes, method, 128, 4))
    values = np.array([point[ALPHA.name] for point in points])
    assert 0.1 <= values.min() < 0.12
    assert 0.28 < values.max() <= 0.3
    assert {point["compensation"] for point in points} == {"coulomb", "lugre"}
    assert {point["plant.seed"] for point in points} == set(range(10))
    worst = np.abs(np.sort(values) - np.linspace(0.1, 0.3, 128)).max() / 0.2
    assert worst < 0.01 if method == "sobol" else 0.01 < worst < 0.2


def test_sobol_sequence_can_be_extended() -> None:
    """A longer sweep begins with the points of a shorter one, up to the same power of two."""
    longer = list(generate_points((ALPHA,), "sobol", 100, 0))
    assert longer[:70] == list(generate_points((ALPHA,), "sobol", 70, 0))


@pytest.mark.parametrize(
    ("parameters", "points", "reason"),
    [((ALPHA,), 0, "1 to"), ((ALPHA,), 10**9, "1 to"), ((ALPHA, ALPHA), 5, "once")],
)
def test_impossible_sweeps_are_rejected(
    parameters: tuple[SweptParameter, ...], points: int, reason: str
) -> None:
    """A sweep has 1 to MAX_POINTS points, and names a parameter once."""
    with pytest.raises(ParameterError, match=reason):
        count_points(parameters, "random", points)
