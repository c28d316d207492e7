"""What results say first, and how their values become text."""

import re
from typing import Any

import numpy as np
import pytest

import furuta
from furuta.results.text import WIDTH, table_text, values_text


@pytest.mark.parametrize(
    ("loop", "sentence"),
    [
        ({}, "swings by 0.511 rad (29.3°) every 2.37 s; it sticks 20 % of the time."),
        ({"gain": [0.0, -7.0, -60.0, -20.0]}, "turns at"),
        ({"gain": [0.0, 0.0, -60.0, -20.0], "friction.law": "coulomb"}, "pendulum falls"),
        ({"zeta1": 1.25}, "between two rests"),
    ],
)
def test_the_first_line_says_what_the_motion_is(loop: dict[str, Any], sentence: str) -> None:
    assert sentence in furuta.limit_cycle(furuta.make_loop(loop)).report().replace("\n", " ")


def test_without_friction_nothing_sticks() -> None:
    without = {"plant.friction.alpha0": 0.0, "plant.friction.alpha1": 0.0}
    run = furuta.simulate(furuta.make_loop(without), 5.0)
    assert not re.search("stick|stuck", run.report())


@pytest.mark.parametrize("kind", [float, np.float64, np.float32, np.array])
def test_text_shows_what_is_known(kind: Any) -> None:
    """Units and errors beside values, degrees beside angles; nothing without a value."""
    values = {"a": kind(1.5), "b_rad": np.pi, "c": None, "d": np.array([]), "f": np.bool_(True)}
    values |= {"e": kind(np.nan), "g": kind(-np.inf)}
    beside = {"units": {"a": "N m"}, "standard_errors": {"a": 0.25}}
    lines = values_text(values | beside).splitlines()
    assert [line.split() for line in lines] == [
        ["a", "1.5", "±", "0.25", "N", "m"],
        ["b_rad", "3.14159", "(180°)"],
        ["f", "yes"],
    ]


def test_a_wide_table_goes_on_below_and_cuts_no_number() -> None:
    row = {"name": "first", **{f"column_{k}_rad": 1.2345 + k for k in range(20)}}
    text = table_text([row])
    assert max(map(len, text.splitlines())) <= WIDTH
    assert all(f"{1.2345 + k:.3g}" in text for k in range(20))
    assert text.count("first") > 1
