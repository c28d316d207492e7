"""The verb ``axis`` as a user meets it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

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


def test_reference_speed_and_unstable_gains(furuta: Any) -> None:
    """A moving reference, and gains that no friction needs to make unbounded."""
    arguments = ("--cascade", "5", "0.1", "0.5", "--reference-speed", "5", "--json")
    assert json.loads(furuta("axis", *AXIS, *arguments)[1])["kind"] == "steady"
    result = json.loads(furuta("axis", *AXIS, "--pid", "1", "100", "0.01", "--json")[1])
    assert (result["kind"], result["recommended"]) == ("unbounded", None)


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A slow motion of a hunting axis, and noise."""
    folder = tmp_path_factory.mktemp("tables")
    friction = library.Friction(alpha0=0.1, alpha1=0.1, stribeck_velocity=0.1, viscous=0.005)
    time = np.arange(0.0, 8.0, 1e-3)
    moves = 0.5 * np.sin(1.3 * time) + 0.2 * np.sin(3.7 * time)
    recorded = library.simulate_axis(
        library.Axis(0.01, friction), library.Pid(3.0, 2.0, 0.1), reference=moves
    )
    library.write_series(folder / "axis.csv", recorded.columns)
    noise = np.cumsum(np.random.default_rng(1).standard_normal((2, len(time))), axis=1)
    columns = {"time": time, "position": 0.1 * noise[0], "torque": noise[1]}
    library.write_series(folder / "noise.csv", columns)
    return folder


def test_a_record_identifies_and_says_what_follows(furuta: Any, tables: Path) -> None:
    """With a controller it counts the draws that hunt."""
    arguments = ("--identify", tables / "axis.csv", "--pid", "1", "2", "0.08", "--json")
    status, out, err = furuta("axis", *arguments)
    assert status == 0, err
    result = json.loads(out)
    found = result["identified"]
    assert found["usable"] == "yes"
    assert abs(found["inertia"] - 0.01) < 3.0 * found["standard_errors"]["inertia"] + 1e-5
    assert len(found["covariance"]["names"]) == len(found["covariance"]["values"])
    assert result["kind"] == "limit_cycle"
    assert result["hunts_in"] == 1.0
    assert result["hunting_rad"][0] < result["peak_to_peak_rad"] < result["hunting_rad"][1]


def test_what_is_not_usable_is_not_used(furuta: Any, tables: Path) -> None:
    """Noise has no inertia, or one that is not usable; either is one line."""
    controller = ("--pid", "1", "2", "0.08")
    status, out, err = furuta("axis", "--identify", tables / "noise.csv", *controller)
    assert status == 1
    assert "kind" not in out
    assert len(err.splitlines()) == 1
