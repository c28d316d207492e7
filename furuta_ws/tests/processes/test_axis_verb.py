"""The verb ``axis`` as a user meets it."""

import json
from pathlib import Path
from typing import Any

import numpy as np

import furuta as library

AXIS = ("--inertia", "0.01", "--friction", "alpha0=0.1,alpha1=0.1,stribeck_velocity=0.1")


def test_hunting_axis(furuta: Any, tmp_path: Path) -> None:
    picture = tmp_path / "axis.png"
    arguments = (*AXIS, "--pid", "1", "2", "0.08", "--out", picture, "--json")
    status, out, err = furuta("axis", *arguments)
    assert status == 0, err
    result = json.loads(out)
    assert result["kind"] == "limit_cycle"
    assert result["stable"] is True
    rows = {row["compensation"]: row["error_rad"] for row in result["compensations"]}
    assert rows[result["recommended"]] < 0.2 * rows["none"]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_record_identifies_and_says_what_follows(furuta: Any, tmp_path: Path) -> None:
    """From a slow motion of a hunting axis; with a controller it counts the draws that hunt."""
    friction = library.Friction(alpha0=0.1, alpha1=0.1, stribeck_velocity=0.1, viscous=0.005)
    time = np.arange(0.0, 8.0, 1e-3)
    moves = 0.5 * np.sin(1.3 * time) + 0.2 * np.sin(3.7 * time)
    recorded = library.simulate_axis(
        library.Axis(0.01, friction), library.Pid(3.0, 2.0, 0.1), reference=moves
    )
    table = tmp_path / "axis.csv"
    library.write_series(table, recorded.columns)
    status, out, err = furuta("axis", "--identify", table, "--pid", "1", "2", "0.08", "--json")
    assert status == 0, err
    result = json.loads(out)
    found = result["identified"]
    assert found["usable"] == "yes"
    assert abs(found["inertia"] - 0.01) < 3.0 * found["standard_errors"]["inertia"] + 1e-5
    assert len(found["covariance"]["names"]) == len(found["covariance"]["values"])
    assert result["kind"] == "limit_cycle"
    assert result["hunts_in"] == 1.0
    assert result["hunting_rad"][0] < result["peak_to_peak_rad"] < result["hunting_rad"][1]
