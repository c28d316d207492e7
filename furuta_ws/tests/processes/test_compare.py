"""The verb ``compare``: its results, files, and nonsense."""

import csv
from pathlib import Path
from typing import Any

import pytest


def test_truths_are_those_of_simulate(answer: Any, tmp_path: Path) -> None:
    """On the nominal rig, with a table, and with the ranking that the rows give."""
    out, own = tmp_path / "named.csv", "mine=compensation=lugre,sigma0=100"
    candidates = ("--candidate", "none", "--candidate", own)
    result = answer("compare", "--truths", "--seconds", 5, "--out", out, *candidates)
    lugre = ("--compensation", "lugre", "--set", "friction_observer.sigma0=100")
    simulated = answer("simulate", "--seconds", 5, *lugre)
    assert len(result["rows"]) == 2 * 54
    size = simulated["phi_peak_to_peak_rad"]
    nominal = {"rig": "nominal", "candidate": "mine", "phi_peak_to_peak_rad": size}
    assert nominal in result["rows"]
    with out.open() as file:
        rows = list(csv.DictReader(file))
    (best,) = [row for row in result["best_bandwidths"] if row["rig"] == "delay 10 lag 15, x 1"]
    assert best["best_bandwidth"] > 0.0
    assert best["residual_at_best_rad"] < result["encoder_count_rad"]
    worst = {score["candidate"]: score["residual_worst_rad"] for score in result["ranking"]}
    for name in ("none", "mine"):
        mine = [row for row in rows if row["candidate"] == name]
        fell = "True" in {row["fell"] for row in mine}
        largest = max(float(row["phi_peak_to_peak_rad"]) for row in mine)
        assert worst[name] == (None if fell else largest), name


def test_rigs_are_as_uncertain_as_the_file_says(answer: Any, tmp_path: Path) -> None:
    """What ``identify --write`` writes is enough; the table has the rigs' parameters."""
    parquet = pytest.importorskip("pyarrow.parquet")
    file, table = tmp_path / "mine.yaml", tmp_path / "a.parquet"
    file.write_text("uncertainty: {standard_errors: {alpha0: 0.001, beta: 0.002}}\n")
    options = ("--rigs", 4, "--seconds", 5, "--push", 2, "--candidate", "lugre", "--out", table)
    (score,) = answer("compare", "--rig", file, *options)["ranking"]
    assert (score["rigs"], score["falls"], score["pushes"]) == (4, 0, 4)
    rows = parquet.read_table(table).to_pylist()
    assert len(rows) == 8
    assert len({row["friction.alpha0"] for row in rows}) == 4
    assert len({row["friction.sigma0"] for row in rows}) == 1
