"""The verb ``axis`` as a user meets it."""

import json
from pathlib import Path
from typing import Any

import pytest

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


@pytest.mark.parametrize(
    ("arguments", "expected", "reason"),
    [
        (AXIS, 2, "either --pid or --cascade"),
        (("--pid", "1", "1", "1"), 2, "--inertia and --friction, or --identify"),
        ((*AXIS[:2], "--friction", "alpha=1", "--pid", "1", "1", "1"), 1, "NAME=VALUE"),
        ((*AXIS[:2], "--identify", "x.csv", "--pid", "1", "1", "1"), 2, "or --identify"),
        (("--identify", "nothing.csv", "--pid", "1", "1", "1"), 1, "no file nothing.csv"),
    ],
)
def test_wrong_usage(furuta: Any, arguments: Any, expected: int, reason: str) -> None:
    status, _, err = furuta("axis", *arguments)
    assert status == expected
    assert reason in err
    assert len(err.splitlines()) == 1
