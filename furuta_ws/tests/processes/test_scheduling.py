"""Scheduling of ``furuta run``: what the system granted is what is reported."""

import csv
import os
from pathlib import Path
from typing import Any

import pytest

from furuta_ros.scheduling import may_have_priority

pytestmark = pytest.mark.realtime


def test_cores_and_timing(processes: Any, tmp_path: Path) -> None:
    """Granted cores and a collector that is off are said, and how late samples were is written."""
    core, table = min(os.sched_getaffinity(0)), tmp_path / "new" / "timing.csv"
    status, out, err = processes.run(
        "run", "--seconds", "2", "--cores", core, "--no-gc", "--timing", table
    )
    assert status == 0, err
    assert f"cores [{core}]: granted, runs on [{core}]" in out
    assert "garbage collector off: granted" in out
    assert "latency   50 % within" in out
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert sum(int(row["latency"]) for row in rows) > 100
    assert sum(int(row["lateness"]) for row in rows) > 100


def test_what_is_granted_or_refused_is_printed(processes: Any) -> None:
    """Whichever it is on this machine, with the cores that there are; the run goes on."""
    status, out, err = processes.run(
        "run", "--seconds", "0.2", "--priority", "10", "--lock-memory", "--cores", "1000"
    )
    assert status == 0, err
    assert "cores [1000]: REFUSED" in out
    assert f"there are {sorted(os.sched_getaffinity(0))}" in out
    granted = "SCHED_FIFO priority 10: granted, SCHED_FIFO 10" in out
    assert granted or "SCHED_FIFO priority 10: REFUSED, Operation not permitted: needs" in out
    assert "memory lock: granted" in out or "memory lock: REFUSED" in out


@pytest.mark.parametrize("option", [(), ("--lockstep",)], ids=str)
def test_beside_a_page_a_graph_takes_a_priority_where_it_may(
    processes: Any, option: tuple[str, ...]
) -> None:
    """Not in lock-step, where it would leave nothing for the page."""
    status, out, err = processes.run("run", "--beside-page", "--seconds", "0.2", *option)
    assert status == 0, err
    assert ("priority 80: granted" in out) == (not option and may_have_priority(80))
    assert os.sched_getscheduler(0) == os.SCHED_OTHER
    assert "REFUSED" not in out


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--cores", "one"], "--cores must be numbers"),
        (["--lockstep", "--timing", "a.csv"], "lock-step"),
        (["--processes", "--priority", "10"], "--processes cannot be combined"),
    ],
)
def test_what_does_not_go_together(furuta: Any, arguments: list[str], reason: str) -> None:
    """Is refused in one line."""
    status, _, err = furuta("run", *arguments)
    assert status == 1
    assert err.startswith("error: ")
    assert reason in err
