"""The verb ``furuta swing-up``."""

from typing import Any

import pytest


@pytest.mark.long
def test_random_starts_and_knocks(answer: Any) -> None:
    """A few starts are upright within the limits; after every push the pendulum swings up again."""
    starts = ("--starts", "5", "--rig", "qube_servo_2")
    report = answer("swing-up", *starts, "--knocks")
    assert (report["starts"], report["upright"], report["beyond_limits"]) == (5, 5, 0)
    assert 0.0 < report["median_s"] <= report["worst_s"] < 10.0
    assert (report["pushes"], report["falls"], report["swing_ups"]) == (5, 5, 5)
    assert 50.0 < report["upright_s"] < 55.0
