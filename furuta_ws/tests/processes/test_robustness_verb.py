"""``furuta robustness`` and ``tune --robust`` as a user runs them."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest

from furuta_bringup.uncertain_rig_options import parse_uncertain
from furuta_model.parameters import ParameterError
from furuta_recordings.table_files import parquet
from furuta_sim.settings.settings import read_file

Furuta = Callable[..., Any]
TIMEOUT = 120.0
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


def test_killed_study_is_resumed(furuta: Furuta, processes: Any, tmp_path: Path) -> None:
    """After SIGKILL the table and the result are those without a kill, to the byte."""
    study = ("--rigs", "300", "--seconds", "30", "--set", "compensation=lugre", "--json")
    status, undisturbed, err = furuta("robustness", *study, "--out", tmp_path / "whole.parquet")
    assert status == 0, err
    out, journal = tmp_path / "a.parquet", tmp_path / "a.parquet.part"
    process = processes.furuta("robustness", *study, "--out", out)
    deadline = monotonic() + TIMEOUT
    while not journal.exists() or journal.read_bytes().count(b"\n") < 10:
        assert monotonic() < deadline, "the study makes no progress"
        sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert not out.exists()
    status, text, err = furuta("robustness", *study, "--out", out)
    assert status == 0, err
    found, expected = json.loads(text), json.loads(undisturbed)
    assert 9 <= found["resumed"] < 300
    for each in ("resumed", "file", "wall_seconds"):
        del found[each], expected[each]
    assert found == expected
    assert out.read_bytes() == (tmp_path / "whole.parquet").read_bytes()
    rows = parquet.read_table(out).to_pylist()
    assert [row["rig"] for row in rows] == list(range(300))
    assert sum(row["fell"] for row in rows) == found["fell"]
    assert not journal.exists()


def test_rigs_are_as_uncertain_as_the_file_says(furuta: Furuta, tmp_path: Path) -> None:
    """What ``identify --write`` writes is enough; ranges and relative errors replace it."""
    file = tmp_path / "mine.yaml"
    file.write_text("uncertainty: {standard_errors: {alpha0: 0.001, beta: 0.002}}\n")
    status, out, err = furuta("robustness", *SHORT, "--rig", file, "--json")
    assert status == 0, err
    found = json.loads(out)
    assert found["standard_errors"] == {"alpha0": 0.001, "beta": 0.002}
    assert found["uncertain"] == {}
    table = tmp_path / "a.csv"
    others = ("--error", "0.1", "--model-error", "0", "--out", table)
    status, out, err = furuta("robustness", *SHORT, "--rig", file, "--json", *others)
    assert status == 0, err
    assert json.loads(out)["standard_errors"] == {}
    assert "alpha0" in table.read_text().splitlines()[0].split(",")


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
