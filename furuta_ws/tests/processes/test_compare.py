"""The verb ``compare``: its results, killed and resumed, on a cluster, and nonsense."""

from __future__ import annotations

import csv
import json
import signal
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest
from distributed import Client, LocalCluster

PNG = b"\x89PNG"
TIMEOUT = 120.0
# Long enough to be killed in between, while tuning and while comparing.
LONG = (
    *("--rows", "random", "--rigs", "12", "--seeds", "2", "--push", "2", "--seconds", "60"),
    *("--candidate", "coulomb", "--candidate", "b=compensation=lugre,sigma0=20:500"),
    *("--tune-budget", "12", "--tuning-rigs", "6"),
)
FILES = ("runs.csv", "rigs.csv", "tuning.json", "summary.json")


def wait_for_lines(journal: Path, lines: int) -> None:
    """Return once the journal has this many lines."""
    deadline = monotonic() + TIMEOUT
    while not journal.exists() or journal.read_text().count("\n") < lines:
        assert monotonic() < deadline, "the comparison makes no progress"
        sleep(0.01)


def table(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of the long comparison without any interruption."""
    from processes.conftest import Processes  # noqa: PLC0415

    out = tmp_path_factory.mktemp("whole")
    processes = Processes()
    process = processes.furuta("compare", *LONG, "--out", out)
    _, err = process.communicate(timeout=TIMEOUT)
    processes.close()
    assert process.returncode == 0, err
    return out


def test_rows_are_those_of_simulate(furuta: Any, tmp_path: Path) -> None:
    """On the nominal rig, with a figure, and with the ranking that the rows give."""
    out = tmp_path / "new" / "named"
    status, text, err = furuta(
        "compare", "--seeds", "1", "--push", "0", "--seconds", "20", "--out", out, "--json",
        "--candidate", "none", "--candidate", "mine=compensation=lugre,sigma0=100",
    )  # fmt: skip
    assert status == 0, err
    simulated = json.loads(
        furuta(
            "simulate", "--seconds", "20", "--compensation", "lugre", "--json",
            "--set", "friction_observer.sigma0=100",
        )[1]
    )  # fmt: skip
    rows = table(out / "runs.csv")
    assert len(rows) == 2 * 15
    (row,) = (r for r in rows if (r["rig"], r["candidate"]) == ("nominal", "mine"))
    size = simulated["phi_peak_to_peak_rad"]
    assert float(row["phi_peak_to_peak_rad"]) == size
    result = json.loads(text)
    assert result == json.loads((out / "summary.json").read_text())
    assert result["residual_rad"]["mine"]["nominal"] == size
    worst = {score["candidate"]: score["residual_worst_rad"] for score in result["ranking"]}
    for name in ("none", "mine"):
        sizes = [float(r["phi_peak_to_peak_rad"]) for r in rows if r["candidate"] == name]
        assert worst[name] == max(sizes)
    assert (out / "comparison.png").read_bytes().startswith(PNG)
    assert len(table(out / "rigs.csv")) == 15


@pytest.mark.parametrize("journal", ["tuning.json.part", "runs.csv.part"])
def test_killed_comparison_is_resumed(
    processes: Any, tmp_path: Path, whole: Path, journal: str
) -> None:
    """After SIGKILL, while tuning or comparing, the results are those without a kill."""
    out = tmp_path / "results"
    process = processes.furuta("compare", *LONG, "--out", out)
    wait_for_lines(out / journal, 2)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert not (out / "runs.csv").exists()
    other = processes.furuta("compare", *LONG, "--seconds", "50", "--out", out)
    _, err = other.communicate(timeout=TIMEOUT)
    assert other.returncode == 1
    assert "another" in err
    again = processes.furuta("compare", *LONG, "--out", out)
    _, err = again.communicate(timeout=TIMEOUT)
    assert again.returncode == 0, err
    for name in FILES:
        assert (out / name).read_bytes() == (whole / name).read_bytes(), name
    assert not list(out.glob("*.part"))


def test_cluster_gives_the_same_results(processes: Any, tmp_path: Path, whole: Path) -> None:
    """To the last byte."""
    with (
        LocalCluster(
            n_workers=1, threads_per_worker=2, processes=True, dashboard_address=None
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        process = processes.furuta(
            "compare", *LONG, "--out", tmp_path, "--scheduler", client.scheduler.addr
        )
        _, err = process.communicate(timeout=TIMEOUT)
    assert process.returncode == 0, err
    for name in FILES:
        assert (tmp_path / name).read_bytes() == (whole / name).read_bytes(), name


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--rigs", "5"], "--rigs needs --rows random"),
        (["--disturb", "lag"], "--disturb needs --rows random"),
        (["--tuning-rigs", "5"], "--tuning-rigs needs --tune-budget"),
        (["--candidate", "nothing"], "one of none"),
        (["--candidate", "a=alpha0=0.1:0.3"], "needs --tune-budget"),
        (["--candidate", "a=plant.seed=1"], "only the plant"),
        (["--set", "plant.sample_time=0.002"], "sample_time"),
        (["--scheduler", "tcp://127.0.0.1:9"], "no Dask scheduler"),
        (["--rows", "random", "--rigs", "1", "--set", "plant.friction.sigma0=1e6"], "no run is"),
    ],
)
def test_bad_comparisons_are_rejected(
    furuta: Any, tmp_path: Path, arguments: list[str], reason: str
) -> None:
    """There is one line that says what is wrong."""
    status, out, err = furuta("compare", *arguments, "--out", str(tmp_path / "a"))
    assert status == 1
    assert out == ""
    assert err.startswith("error: ")
    assert reason in err
    assert err.count("\n") == 1


def test_results_are_not_overwritten(furuta: Any, tmp_path: Path) -> None:
    """A directory with a complete comparison is left as it is."""
    (tmp_path / "runs.csv").write_text("mine")
    status, _, err = furuta("compare", "--out", str(tmp_path))
    assert status == 1
    assert "already exists" in err
    assert (tmp_path / "runs.csv").read_text() == "mine"
