"""The verb ``sweep``: on this machine, killed and resumed, and on a cluster."""

import csv
import json
import os
import signal
from pathlib import Path
from typing import Any

import pytest
from processes.conftest import TIMEOUT, Processes, wait_for

# Long enough to be killed in between, and with an impossible point.
LONG = ("plant.seed=0:59:60", "sigma1=1.0,1.5,1e9", "--seconds", "60")


def finished_runs(journal: Path) -> int:
    """The number of runs in the journal, 0 if there is none yet; its first line describes it."""
    return max(0, journal.read_bytes().count(b"\n") - 1) if journal.exists() else 0


def table(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The table of the long sweep without any interruption."""
    out = tmp_path_factory.mktemp("whole") / "sweep.csv"
    processes = Processes()
    status, _, err = processes.run("sweep", *LONG, "--out", out)
    assert status == 0, err
    return out.read_bytes()


def test_rows_are_those_of_simulate(furuta: Any, tmp_path: Path) -> None:
    out = tmp_path / "new" / "a.csv"
    status, text, err = furuta(
        "sweep", "friction_observer.alpha0=0.1:0.3:3", "compensation=coulomb,lugre",
        "--seconds", "20", "--out", out, "--json",
    )  # fmt: skip
    assert status == 0, err
    assert json.loads(text) == {
        "runs": 6, "resumed": 0, "fell": 0, "impossible": 0, "file": str(out)
    }  # fmt: skip
    rows = table(out)
    simulated = json.loads(
        furuta(
            "simulate", "--seconds", "20", "--compensation", "lugre", "--json",
            "--set", "friction_observer.alpha0=0.2",
        )[1]
    )  # fmt: skip
    (row,) = (r for r in rows if r["compensation"] == "lugre" and "0.2" in r[next(iter(r))][:4])
    for name in ("phi_peak_to_peak_rad", "theta_peak_to_peak_rad", "stuck_fraction", "steps"):
        assert float(row[name]) == simulated[name], name
    assert not list(tmp_path.rglob("*.part"))


@pytest.mark.long
def test_killed_sweep_is_resumed(furuta: Any, processes: Any, tmp_path: Path, whole: bytes) -> None:
    """After SIGKILL no run is repeated, and the table is that of an undisturbed sweep."""
    out = tmp_path / "sweep.csv"
    journal = tmp_path / "sweep.csv.part"
    process = processes.furuta("sweep", *LONG, "--out", out)
    wait_for(lambda: finished_runs(journal) >= 20)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert not out.exists()
    recorded = finished_runs(journal)
    other = processes.furuta("sweep", *LONG[:2], "--seconds", "5", "--out", out)
    _, err = other.communicate(timeout=TIMEOUT)
    assert other.returncode == 1
    assert "another sweep" in err
    again = processes.furuta("sweep", *LONG, "--out", out, "--json")
    text, err = again.communicate(timeout=TIMEOUT)
    assert again.returncode == 0, err
    assert json.loads(text)["resumed"] == recorded >= 20
    assert out.read_bytes() == whole
    assert not journal.exists()


@pytest.mark.long
def test_cluster_loses_workers(processes: Any, tmp_path: Path, whole: bytes) -> None:
    distributed = pytest.importorskip("distributed")
    out = tmp_path / "sweep.csv"
    with (
        distributed.LocalCluster(
            n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        process = processes.furuta(
            "sweep", *LONG, "--out", out, "--scheduler", client.scheduler.addr
        )
        wait_for(lambda: finished_runs(tmp_path / "sweep.csv.part") >= 12)
        workers = list(client.run(os.getpid).values())
        for worker in workers[:2]:
            os.kill(worker, signal.SIGKILL)
        _, err = process.communicate(timeout=TIMEOUT)
        assert process.returncode == 0, err
    assert out.read_bytes() == whole
