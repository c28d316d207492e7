"""``furuta robustness`` and ``tune --robust`` as a user runs them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from furuta_cli.verbs.robustness import parse_uncertain
from furuta_graph.settings import read_file
from furuta_model.parameters import ParameterError

Furuta = Callable[..., Any]
SHORT = ("--rigs", "20", "--seconds", "5", "--set", "compensation=lugre")


def test_robustness_prints_probabilities_and_draws(furuta: Furuta, tmp_path: Path) -> None:
    """The JSON holds the probability with its interval; the picture exists."""
    picture = tmp_path / "map.png"
    status, out, err = furuta("robustness", *SHORT, "--json", "--out", picture, "--bound", "0.1")
    assert status == 0, err
    found = json.loads(out)
    assert found["runs"] == 20
    assert found["within_bound_low"] <= found["within_bound"] <= found["within_bound_high"]
    assert found["fell"] == 0
    assert 0.0 < found["p95_rad"] <= found["worst_rad"]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_tune_robust_writes_a_parameter_file(furuta: Furuta, tmp_path: Path) -> None:
    """With the quantile before and after on fresh rigs."""
    file = tmp_path / "robust.yaml"
    arguments = ("--robust", "--rigs", "20", "--fresh-rigs", "20", "--trials", "10")
    status, out, err = furuta("tune", *arguments, "--json", "--out", file)
    assert status == 0, err
    found = json.loads(out)
    assert found["tuned_on"]["p95_after_rad"] <= found["tuned_on"]["p95_before_rad"]
    assert found["before"]["p95_rad"] > 0.0
    assert read_file(file)["friction_observer"] == found["parameters"]


def test_bad_input_is_one_line(furuta: Furuta) -> None:
    """That says what is allowed."""
    status, out, err = furuta("robustness", "gamma=0.01:0.03", "--rigs", "20")
    assert (status, out) == (1, "")
    assert "alpha * beta must exceed" in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("alpha0=0.3:0.1", "needs finite LOW < HIGH"),
        ("alpha0=nan:1", "needs finite LOW < HIGH"),
        ("alpha0=1", "expected NAME=LOW:HIGH"),
        ("alpha0=1:2:3", "expected NAME=LOW:HIGH"),
        ("mode=0:1", "uncertain can be sigma0"),
    ],
)
def test_bad_ranges_are_rejected(text: str, message: str) -> None:
    """With what is allowed."""
    with pytest.raises(ParameterError, match=message):
        parse_uncertain(text)
