"""The verb ``furuta swing-up``."""

from __future__ import annotations

import json
from typing import Any

import pytest


def test_random_starts(furuta: Any) -> None:
    """All of a few starts on a rig that is chosen by name are upright within its limits."""
    status, out, err = furuta("swing-up", "--starts", "5", "--rig", "qube_servo_2", "--json")
    assert status == 0, err
    found = json.loads(out)
    assert (found["starts"], found["upright"], found["beyond_limits"]) == (5, 5, 0)
    assert 0.0 < found["median_s"] <= found["worst_s"] < 10.0


def test_benchmark_needs_a_rig_that_can(furuta: Any) -> None:
    """The benchmark refuses a rig that cannot see the hanging pendulum, with the reason."""
    status, out, err = furuta("benchmark-swing-up", "--rig", "paper")
    assert (status, out) == (1, "")
    assert "potentiometer_range must be at least" in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--rig", "nobody"), "no rig nobody"),
        (("--rig", "paper"), "potentiometer_range must be at least"),
        (("--set", "estimator.method=kalman"), "whole_circle"),
    ],
)
def test_bad_input_is_one_line(furuta: Any, arguments: tuple[str, ...], message: str) -> None:
    """A rig that cannot see the hanging pendulum is refused, with the reason."""
    status, out, err = furuta("swing-up", "--starts", "1", *arguments)
    assert status in (1, 2)
    assert out == ""
    assert message in err
    assert len(err.splitlines()) == 1
