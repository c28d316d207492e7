"""The verbs ``linearize`` and ``limit-cycle`` as a user meets them."""

from pathlib import Path
from typing import Any

import pytest

from furuta.settings import settings
from furuta_ros.yaml_files import read_yaml


def test_nyquist(answer: Any) -> None:
    """Of Fig. 4 case a crosses, b does not; --feedback replaces the gain everywhere."""
    result = answer("linearize", "--figure-4")
    assert [(crossing["case"], crossing["omega_rad_s"]) for crossing in result["crossings"]] == [
        ("a", pytest.approx(3.057, abs=1e-3)),
        ("c", 0.0),
        ("d", 0.0),
    ]
    result = answer("linearize", "--nyquist", "--feedback", 10, 4, 60, 20)
    assert result["L"] == [-10, -4, -60, -20]
    assert result["crossings"][0]["omega_rad_s"] == pytest.approx(3.057, abs=1e-3)


def test_prediction_takes_parameters_and_feedback(answer: Any) -> None:
    """Friction twice as strong, cycle twice as wide; without φ no cycle but rotations."""
    predict = ("limit-cycle", "--predict")
    (cycle,) = answer(*predict, "--law", "coulomb", "--set", "alpha0=0.42")["cycles"]
    assert cycle["phi_peak_to_peak_rad"] == pytest.approx(2 * 0.6425, abs=2e-4)
    assert cycle["stable"] is True
    result = answer(*predict, "--feedback", 0, 7, 60, 20)
    assert result["cycles"] == []
    rates = [rotation["rate_rad_s"] for rotation in result["rotations"]]
    assert rates == pytest.approx([0.03208, -0.03208], abs=1e-5)


def test_a_map_has_corners_that_are_impossible(answer: Any) -> None:
    ranges = ("--over", "omega1=-2:7:2", "--over", "omega2=-2:5:2")
    rows = answer("limit-cycle", *ranges)["rows"]
    assert [row["kind"] for row in rows] == [*["impossible"] * 3, "limit_cycle"]
    assert rows[-1]["phi_peak_to_peak_rad"] == pytest.approx(0.5106, rel=5e-4)


def test_files_are_read_once(answer: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that is edited meanwhile changes no part of a map."""
    reads: list[Path] = []
    monkeypatch.setattr(
        settings, "read_yaml", lambda *given: reads.append(given[0]) or read_yaml(*given)
    )
    file = tmp_path / "poles.yaml"
    file.write_text("controller: {ros__parameters: {zeta1: 0.8}}")
    ranges = ("--over", "omega1=6:7:2", "--over", "omega2=4:5:2")
    assert len(answer("limit-cycle", *ranges, "--params", file)["rows"]) == 4
    assert reads == [file]
