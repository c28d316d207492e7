"""The verb ``furuta swing-up``."""

import json
from typing import Any

import pytest


def test_random_starts_and_knocks(furuta: Any) -> None:
    """A few starts are upright within the limits; after every push the pendulum swings up again."""
    starts = ("--starts", "5", "--rig", "qube_servo_2")
    status, out, err = furuta("swing-up", *starts, "--knocks", "--json")
    assert status == 0, err
    report = json.loads(out)
    assert (report["starts"], report["upright"], report["beyond_limits"]) == (5, 5, 0)
    assert 0.0 < report["median_s"] <= report["worst_s"] < 10.0
    assert (report["pushes"], report["falls"], report["swing_ups"]) == (5, 5, 5)
    assert 50.0 < report["upright_s"] < 55.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--rig", "nobody"), "no rig nobody"),
        (("--rig", "paper"), "potentiometer_range must be at least"),
        (("--set", "estimator.method=kalman"), "whole_circle"),
    ],
)
def test_bad_input_is_one_line(furuta: Any, arguments: tuple[str, ...], message: str) -> None:
    status, out, err = furuta("swing-up", "--starts", "1", *arguments)
    assert status in (1, 2)
    assert out == ""
    assert message in err
    assert len(err.splitlines()) == 1
