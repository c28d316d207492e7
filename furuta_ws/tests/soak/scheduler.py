"""Divides the time of a soak among its campaigns, and runs each slice in a process of its own."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from math import ceil
from pathlib import Path
from threading import Thread
from time import monotonic
from typing import Any

from soak.load import LoadMeter
from soak.record import Record, Slice
from soak.report import write_report
from soak.resources import ResourceMonitor

# Campaigns that run one after the other, with their shares of the time. Lanes run side by side:
# that is the load under which the rig and the processes are tested.
LANES: tuple[dict[str, float], ...] = (
    {"rig": 1.0},
    {"lockstep_processes": 1.0, "realtime_processes": 1.0},
    {"messages": 14.0, "graph": 4.0, "wire": 2.0, "plant": 2.0, "full_disk": 1.0},
)
# Longest time [s] until every campaign has had its turn.
ROUND = 300.0
# Time [s] beyond its own that a slice may take to start and to end.
GRACE = 150.0


def run_slice(part: Slice) -> Record:
    """Run a slice in this process."""
    record, watch = Record(part), ResourceMonitor()
    import_module(f"soak.campaigns.{part.campaign}").run(record, watch)
    watch.check(record)
    return record


def run_soak(seconds: float, seed: int, out: Path) -> int:
    """Run all campaigns for ``seconds``; returns 1 if an oracle is broken, otherwise 0."""
    results: list[dict[str, Any]] = []
    with LoadMeter() as load:
        lanes = [
            # Daemons, so that Ctrl-C ends the soak and not only the wait for them.
            Thread(
                target=_run_lane, args=(list(plan(lane, seconds, seed)), out, results), daemon=True
            )
            for lane in LANES
        ]
        for lane in lanes:
            lane.start()
        for lane in lanes:
            lane.join()
    return write_report(out, results, load.summary(), seconds, seed)


def plan(lane: dict[str, float], seconds: float, seed: int) -> Iterator[Slice]:
    """The slices of a lane: rounds of all its campaigns, however short the soak is."""
    rounds = ceil(seconds / ROUND)
    for number in range(rounds):
        for campaign, share in lane.items():
            yield Slice(campaign, number, seed, seconds / rounds * share / sum(lane.values()))


def _run_lane(parts: list[Slice], out: Path, results: list[dict[str, Any]]) -> None:
    end = monotonic() + sum(part.seconds for part in parts)
    for k, part in enumerate(parts):
        # What starting takes is taken from the time of all slices that are left.
        left = sum(each.seconds for each in parts[k:])
        share = part.seconds / left if left else 0.0
        results.append(_run_process(part._replace(seconds=share * (end - monotonic())), out))


def _run_process(part: Slice, out: Path) -> dict[str, Any]:
    """Run a slice in a process with its own log; a slice without a result is a failure."""
    command = [sys.executable, "-m", "soak", "--slice", part.name, "--seed", str(part.seed)]
    command += ["--minutes", str(max(part.seconds, 1.0) / 60.0), "--out", str(out)]
    name = f"{part.campaign}-{part.number}"
    with (out / f"{name}.log").open("w") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log)
        try:
            status: int | str = process.wait(part.seconds + GRACE)
        except subprocess.TimeoutExpired:
            _interrupt(process)
            status = "none, it did not end"
    file = out / f"{name}.json"
    if status in (0, 1) and file.exists():
        result: dict[str, Any] = json.loads(file.read_text())
        return result
    record = Record(part)
    record.check("survival", f"the slice ended with status {status}, see {name}.log")
    return record.as_json()


def _interrupt(process: subprocess.Popen[bytes]) -> None:
    """End a slice; SIGINT first, so that it ends its own processes."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(GRACE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
