"""The verb ``sweep``: on this machine, and on a cluster."""

import csv
from pathlib import Path
from typing import Any

import pytest


def test_the_recommended_setting_follows_from_each_point(answer: Any, tmp_path: Path) -> None:
    """A run gives what ``simulate`` gives, whose strength depends on the drive."""
    out, asked = tmp_path / "a.csv", ("--set", "compensation=recommended")
    found = answer("sweep", "drive.lag=0,0.04", "--seconds", 20, "--out", out, *asked)
    assert (found["runs"], found["file"]) == (2, str(out))
    with out.open() as file:
        row = list(csv.DictReader(file))[1]
    alone = answer("simulate", "--seconds", 20, "--set", "drive.lag=0.04", *asked)
    assert float(row["phi_peak_to_peak_rad"]) == alone["phi_peak_to_peak_rad"]


def test_the_last_choice_of_a_compensation_counts(furuta: Any, tmp_path: Path) -> None:
    tables = []
    for number, choices in enumerate((["recommended", "coulomb"], ["coulomb"])):
        out, given = tmp_path / f"{number}.csv", [f"compensation={name}" for name in choices]
        assignments = [word for text in given for word in ("--set", text)]
        assert furuta("sweep", "seed=1,2", "--seconds", "5", "--out", out, *assignments)[0] == 0
        tables.append(out.read_bytes())
    assert tables[0] == tables[1]


@pytest.mark.parametrize("swept", ["drive.lag=0:0.01:2", "drive.delay=0:4:2", "tilt.x=0:0.1:2"])
def test_ranges_of_what_the_ideal_loop_lacks(answer: Any, tmp_path: Path, swept: str) -> None:
    assert answer("sweep", swept, "--seconds", 5, "--out", tmp_path / "a.csv")["runs"] == 2


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
