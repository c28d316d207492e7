"""The independent truth that standard errors are judged by: exact where a closed form is known."""

import re
from importlib import import_module

import numpy as np
import pytest
from sources import ROOT

import furuta
from furuta_recordings.recording import Recording

TRUTH = ("sticking_motion", "logged_motions", "logged_chains", "logged_rigs")


@pytest.fixture(autouse=True)
def _on_path(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))


@pytest.mark.parametrize("name", TRUTH)
def test_the_truth_shares_no_code_with_the_library(name: str) -> None:
    text = (ROOT / "benchmarks" / f"{name}.py").read_text(encoding="utf-8")
    assert not re.search(r"^\s*(from|import) furuta", text, re.MULTILINE)


def test_a_slide_stops_where_its_closed_form_ends() -> None:
    """And sticks there until the torque exceeds friction and stiction."""
    sticking = import_module("sticking_motion")
    moved, axis = sticking.moved, sticking.Axis(inertia=2.0, alpha0=1.0, alpha1=0.5)
    stopped = moved(axis, (0.0, 1.0, 0.0), 0.0, 0.0, 3.0)
    np.testing.assert_allclose(stopped, (1.0, 0.0, 0.0), atol=1e-9)
    assert moved(axis, stopped, 1.499, 0.0, 1.0)[0] == stopped[0]
    position, speed, _ = moved(axis, stopped, 1.501, 0.0, 1.0)
    np.testing.assert_allclose((position, speed), (1.0 + 0.25 * 0.501, 0.5 * 0.501), atol=1e-9)


def test_a_stuck_arm_holds_until_the_drive_exceeds_friction() -> None:
    log, measured = import_module("logged_rigs").logged_rig(0)
    moves = np.flatnonzero(np.abs(log.command) > 0.0)
    assert np.all(measured[: moves[0], 0] == 0.0)
    assert np.ptp(measured[:, 2]) > 0.1


def test_a_measured_torque_is_logged_after_it_acted() -> None:
    draw = import_module("logged_motions").logged_axis
    for log in map(draw, (2, 3, 5)):
        assert ("torque measured" in log.traits) == (log.values["delay"] < 0.0)
        assert len(log.time) == len(log.position) == len(log.command)


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(3010, id="an arm that sticks"),
        pytest.param(3009, id="slow reversals, which look late", marks=pytest.mark.long),
        pytest.param(3019, id="a wave too small to be found", marks=pytest.mark.long),
    ],
)
def test_errors_of_a_sticking_arm_hold(seed: int) -> None:
    """Its stiffness, delay or waves that were not found explain no false certainty."""
    log, measured = import_module("logged_rigs").logged_rig(seed)
    recording = Recording("rig", log.time, measured, log.time, log.command, in_radians=True)
    fit = furuta.identify(recording)
    known = fit.standard_errors.keys() & log.values.keys()
    assert fit.usable == "yes" and len(known) >= 7
    for name in known:
        off = (fit.values[name] - log.values[name]) / fit.standard_errors[name]
        assert abs(off) < 3.0, name
