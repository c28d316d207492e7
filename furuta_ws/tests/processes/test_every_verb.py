"""The usual call of every verb, whatever versions of the libraries are installed."""

from pathlib import Path
from typing import Any

import pytest

from furuta_bringup import main

pytestmark = [pytest.mark.long, pytest.mark.noble]

# Those with a graph that runs, and the demo, are called in test_command_line, test_start_and_end
# and below.
WITH_A_GRAPH = {"demo", "view", "param", "reset"}
CALLS = (
    "run --lockstep --seconds 10 --record bag",
    "bag info bag",
    "bag export bag --out bag.parquet",
    "bag export bag --out bag.mat",
    "plot bag --out bag.png",
    "plot bag.parquet --out table.svg",
    "identify bag --zero upright --out residuals.png",
    "simulate --compensation lugre --seconds 5 --out run.csv",
    "simulate --seconds 5 --out run.pdf",
    "swing-up --starts 1",
    "sweep alpha0=0.1:0.3:3 --seconds 5 --out sweep.parquet",
    "compare --rigs 2 --seconds 5 --out compare.png",
    "compare --rigs 2 --seconds 5 --candidate lugre=sigma1=0.1:10 --tune-budget 3",
    "linearize --nyquist --out nyquist.png",
    "linearize --passivity",
    "limit-cycle --out cycle.png",
    "limit-cycle --predict",
    "limit-cycle --over omega1=2:12:3 --over zeta1=0.5:0.9:3 --out map.png",
    "theorem stiction --loops 3",
    "axis --inertia 0.01 --friction alpha0=0.1 --pid 1 2 0.08 --out axis.png",
    "export c --out exported",
    "tune --seconds 110",
    "hw rig paper",
    "hw check --port mock --seconds 0.1",
    "node list",
    "param defaults plant",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where all calls are made, one after the other."""
    return Path(tmp_path_factory.mktemp("calls"))


@pytest.mark.parametrize("call", CALLS)
def test_call(furuta: Any, folder: Path, monkeypatch: pytest.MonkeyPatch, call: str) -> None:
    """It prints a result and no warning, and writes what it is to write."""
    if ".parquet" in call:
        pytest.importorskip("pyarrow")
    monkeypatch.chdir(folder)
    arguments = call.split()
    status, out, err = furuta(*arguments)
    assert status == 0, err
    assert out.strip()
    assert "Warning" not in err
    if "--out" in arguments:
        written = folder / arguments[arguments.index("--out") + 1]
        assert written.stat().st_size > 0


def test_page(processes: Any) -> None:
    """The address is printed when the page can be opened."""
    pytest.importorskip("viser")
    page = processes.furuta("view", "--no-open")
    assert "http://127.0.0.1:" in page.stdout.readline()


def test_every_verb_is_called() -> None:
    """A new verb gets its call here."""
    assert {call.partition(" ")[0] for call in CALLS} | WITH_A_GRAPH == set(main.VERBS)
