"""Every result is a dictionary, a text and a figure, in the words of the table in CONTRIBUTING."""

import copy
import json
import pickle
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest

import furuta
from furuta.results.result import Result
from furuta.results.text import WIDTH, table_text, values_text

FRICTION = furuta.Friction(alpha0=1.0, alpha1=0.5)
JOINT = furuta.friction_joint(
    (np.array([[-1.0, 4.0, 1.5], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), [1.0, 0.0, 0.0], [1, 0, 0]),
    FRICTION,
    "stiction",
)
OMEGAS = {"omega1": [6.0, 7.0], "omega2": [5.0]}
RESULTS: dict[str, Any] = {
    "simulate": lambda: furuta.simulate(seconds=12.0),
    "measure": lambda: furuta.measure(seconds=12.0),
    "limit_cycle": furuta.limit_cycle,
    "joint": lambda: furuta.limit_cycle(JOINT),
    "predict_cycles": furuta.predict_cycles,
    "prediction of a joint": lambda: furuta.predict_cycles(JOINT),
    "cycle_branch": lambda: furuta.cycle_branch(None, "viscous", 0.0, 0.02),
    "cycle_map": lambda: furuta.cycle_map(None, OMEGAS),
    "linear_model": lambda: furuta.linear_model(nyquist=True, passivity=True),
    "series": lambda: furuta.simulate(seconds=0.1).series(),
}
WITHOUT_FIGURE = ("measure", "prediction of a joint")


@pytest.mark.parametrize("name", RESULTS)
def test_results_have_one_form(name: str) -> None:
    """A dictionary of plain values, text within the width, a figure; and they can be copied."""
    result = RESULTS[name]()
    assert isinstance(result, Result)
    text = json.dumps(result.to_dict())
    assert json.loads(text).keys() == result.to_dict().keys()
    lines = result.report().splitlines()
    assert lines and max(map(len, lines)) <= WIDTH
    assert repr(result) == result.report()
    assert json.dumps(pickle.loads(pickle.dumps(copy.copy(result))).to_dict()) == text
    if name in WITHOUT_FIGURE:
        with pytest.raises(furuta.ParameterError, match="no figure"):
            result.plot()
        return
    axes = result.plot()
    size = np.size(axes)
    figure, own = plt.subplots(size, squeeze=False)
    assert all(axis.figure is figure for axis in np.ravel(result.plot(own)))
    assert all(axis.has_data() for axis in np.ravel(own))
    with pytest.raises(furuta.ParameterError, match=rf"has {size} axes, given {size + 1}"):
        result.plot(plt.subplots(size + 1)[1])
    plt.close("all")


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


def test_a_run_that_fell_says_so_first() -> None:
    run = furuta.simulate(furuta.make_loop({"plant.friction.alpha0": 21.0}), 5.0)
    assert run.report().startswith("The pendulum fell after 0.8")
    assert run.to_dict()["fell"]


def test_without_friction_nothing_sticks() -> None:
    without = {"plant.friction.alpha0": 0.0, "plant.friction.alpha1": 0.0}
    run = furuta.simulate(furuta.make_loop(without), 5.0)
    assert "stick" not in run.report()
    assert "stuck" not in run.report()


def test_text_shows_what_is_known() -> None:
    """Units and errors beside values, degrees beside angles; nothing without a value."""
    values = {"a": 1.5, "b_rad": np.pi, "c": None, "d": [], "e": float("nan"), "f": True}
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
