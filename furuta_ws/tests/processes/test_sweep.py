"""The verb ``sweep``: on this machine, and on a cluster."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest


def test_rows_are_those_of_simulate(furuta: Any, tmp_path: Path) -> None:
    """The result names the smallest and the largest swing, and is drawn."""
    out, figure = tmp_path / "new" / "a.csv", tmp_path / "a.png"
    swept = "friction_observer.alpha0=0.1:0.3:3", "compensation=coulomb,lugre"
    files = "--out", out, "--figure", figure
    status, text, err = furuta("sweep", *swept, "--seconds", "20", *files, "--json")
    assert status == 0, err
    found = json.loads(text)
    written = {"runs": 6, "fell": 0, "impossible": 0, "file": str(out), "figure": str(figure)}
    assert found.items() >= written.items()
    assert figure.stat().st_size > 10_000
    with out.open() as file:
        rows = list(csv.DictReader(file))
    sizes = [float(row["phi_peak_to_peak_rad"]) for row in rows]
    assert found["smallest"]["phi_peak_to_peak_rad"] == min(sizes)
    assert found["largest"]["compensation"] == rows[sizes.index(max(sizes))]["compensation"]
    simulated = json.loads(
        furuta(
            "simulate", "--seconds", "20", "--compensation", "lugre", "--json",
            "--set", "friction_observer.alpha0=0.2",
        )[1]
    )  # fmt: skip
    (row,) = (r for r in rows if r["compensation"] == "lugre" and "0.2" in r[next(iter(r))][:4])
    for name in ("phi_peak_to_peak_rad", "theta_peak_to_peak_rad", "stuck_fraction", "steps"):
        assert float(row[name]) == simulated[name], name


def test_the_recommended_setting_follows_from_each_point(furuta: Any, tmp_path: Path) -> None:
    """A run gives what ``simulate`` gives, whose strength depends on the drive."""
    out, asked = tmp_path / "a.csv", ("--set", "compensation=recommended")
    assert furuta("sweep", "drive.lag=0,0.04", "--seconds", "20", "--out", out, *asked)[0] == 0
    with out.open() as file:
        row = list(csv.DictReader(file))[1]
    alone = furuta("simulate", "--seconds", "20", "--set", "drive.lag=0.04", *asked, "--json")[1]
    assert float(row["phi_peak_to_peak_rad"]) == json.loads(alone)["phi_peak_to_peak_rad"]


def test_the_last_choice_of_a_compensation_counts(furuta: Any, tmp_path: Path) -> None:
    tables = []
    for number, choices in enumerate((["recommended", "coulomb"], ["coulomb"])):
        out, given = tmp_path / f"{number}.csv", [f"compensation={name}" for name in choices]
        assignments = [word for text in given for word in ("--set", text)]
        assert furuta("sweep", "seed=1,2", "--seconds", "5", "--out", out, *assignments)[0] == 0
        tables.append(out.read_bytes())
    assert tables[0] == tables[1]


@pytest.mark.parametrize("swept", ["drive.lag=0:0.01:2", "drive.delay=0:4:2", "tilt.x=0:0.1:2"])
def test_ranges_of_what_the_ideal_loop_lacks(furuta: Any, tmp_path: Path, swept: str) -> None:
    out = tmp_path / "a.csv"
    status, text, err = furuta("sweep", swept, "--seconds", "5", "--out", out, "--json")
    assert status == 0, err
    assert json.loads(text)["runs"] == 2


@pytest.mark.long
def test_a_cluster_gives_the_same_table(processes: Any, tmp_path: Path) -> None:
    """Also the reasons why runs are impossible."""
    distributed = pytest.importorskip("distributed")
    swept = ("sweep", "plant.seed=0:29:30", "sigma1=1.0,1e9", "--seconds", "5", "--out")
    here, there = tmp_path / "here.csv", tmp_path / "there.csv"
    with distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster:
        for out, place in ((here, ()), (there, ("--scheduler", cluster.scheduler_address))):
            status, _, err = processes.run(*swept, out, *place)
            assert status == 0, err
    assert here.read_bytes() == there.read_bytes()
