"""The verbs on exact limit cycles: keys, pictures, refusals."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest


def test_limit_cycle(furuta: Any, tmp_path: Path) -> None:
    """All keys of the answer, and a picture."""
    picture = tmp_path / "cycle.png"
    status, out, err = furuta("limit-cycle", "--json", "--out", picture)
    assert status == 0, err
    answer = json.loads(out)
    assert answer["kind"] == "oscillation"
    assert answer["phi_peak_to_peak_rad"] == pytest.approx(0.5106, rel=5e-4)
    assert answer["stable"]
    assert len(answer["floquet_multipliers"]) == 4
    assert {"theta_peak_to_peak_rad", "period_s", "rotation_rate_rad_s", "stuck_fraction"} <= set(
        answer
    )
    assert picture.stat().st_size > 10_000


def test_branch(furuta: Any, tmp_path: Path) -> None:
    """The branch over a parameter with its fold."""
    picture = tmp_path / "branch.png"
    status, out, err = furuta(
        "limit-cycle", "--branch", "viscous=0:0.3", "--json", "--out", picture
    )
    assert status == 0, err
    answer = json.loads(out)
    folds = [event["viscous"] for event in answer["events"] if event["event"] == "fold"]
    assert folds == [pytest.approx(0.2095, abs=1e-3)]
    assert {point["stable"] for point in answer["branch"]} == {True, False}
    assert picture.stat().st_size > 10_000


def test_map(furuta: Any, tmp_path: Path) -> None:
    """A map as picture and data, predicted beside exact."""
    picture, data = tmp_path / "map.png", tmp_path / "map.csv"
    status, out, err = furuta(
        "map", "omega1=5:9:3", "l4=1.2:1.5:2", "--out", picture, "--data", data, "--json"
    )
    assert status == 0, err
    rows = json.loads(out)["rows"]
    assert len(rows) == 6
    assert rows[0]["predicted_phi_peak_to_peak_rad"] > rows[0]["phi_peak_to_peak_rad"] > 0
    with data.open() as file:
        assert [float(row["omega1"]) for row in csv.DictReader(file)] == [5, 5, 7, 7, 9, 9]
    assert picture.stat().st_size > 10_000


def test_map_where_nothing_oscillates(furuta: Any, tmp_path: Path) -> None:
    """Without friction every loop comes to rest, which can be drawn too."""
    picture = tmp_path / "map.png"
    frictionless = ("--set", "alpha0=0", "--set", "alpha1=0")
    status, out, err = furuta(
        "map", "omega1=5:7:2", "zeta1=0.5:0.7:2", *frictionless, "--out", picture, "--json"
    )
    assert status == 0, err
    assert {row["kind"] for row in json.loads(out)["rows"]} == {"rest"}
    assert picture.exists()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["limit-cycle", "--feedback", "0", "7", "60", "20", "--out", "x.png"], "no limit cycle"),
        (["limit-cycle", "--feedback", "0", "0", "0", "0"], "does not stabilise"),
        (["limit-cycle", "--feedback", "1", "1", "1", "nan"], "must be finite"),
        (["limit-cycle", "--set", "sigma0=-1"], "sigma0 must be"),
        (["limit-cycle", "--set", "gamma=1"], "must exceed gamma²"),
        (["limit-cycle", "--branch", "viscous"], "NAME=LOW:HIGH"),
        (["limit-cycle", "--branch", "viscous=1:0"], "LOW < HIGH"),
        (["limit-cycle", "--branch", "viscosity=0:1"], "did you mean viscous"),
        (["map", "omega1=1:2", "omega1=1:2"], "two different parameters"),
        (["map", "omega1=-2:-1", "zeta1=0:1"], "omega1 must be"),
        (["map", "omega1=1:2:1", "zeta1=0:1"], "COUNT must be"),
    ],
)
def test_impossible_questions_get_one_line(furuta: Any, arguments: list[str], reason: str) -> None:
    """What is wrong, in one line, with status 1."""
    status, out, err = furuta(*arguments)
    assert status == 1
    assert out == ""
    assert reason in err
    assert len(err.strip().splitlines()) == 1
