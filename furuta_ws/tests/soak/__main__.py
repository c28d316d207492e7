"""``python -m soak``: run a soak for some minutes, or repeat one slice of it.

The campaigns run side by side: that is the load under which rig and processes are tested. Each
slice is a process of its own. Prints what was checked and every failure; ``report.json`` holds all
counts. The exit status is 1 if an oracle is broken.
"""

import argparse
import faulthandler
import json
import signal
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from importlib import import_module
from math import ceil
from pathlib import Path
from typing import Any

from ros_domain import take_domain

from soak.oracles import ORACLES
from soak.record import Record, Slice
from soak.resources import ResourceMonitor

CAMPAIGNS = ("rig", "lockstep_processes", "messages")
# Longest time of a slice [s].
LONGEST_SLICE = 300.0
# Time [s] beyond its own that a slice may take to start and to end, and after which it shows where
# it is.
GRACE, PATIENCE = 150.0, 30.0


def main() -> int:
    """Entry point; returns the exit status."""
    options = _options()
    out: Path = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    if options.slice is None:
        return _run_soak(options.minutes * 60.0, options.seed, out)
    campaign, _, number = options.slice.partition(":")
    part = Slice(campaign, int(number or 0), options.seed, options.minutes * 60.0, options.steps)
    faulthandler.dump_traceback_later(part.seconds + PATIENCE)
    domain = take_domain()
    record = run_slice(part)
    domain.close()
    faulthandler.cancel_dump_traceback_later()
    _result_file(part, out).write_text(json.dumps(record.as_json(), indent=1))
    _print_failures(record.as_json())
    return int(bool(record.failures))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0, help="duration [min]")
    parser.add_argument("--seed", type=int, default=1, help="seed of all random choices")
    parser.add_argument("--out", type=Path, default=Path("soak"), help="directory of the report")
    parser.add_argument("--slice", help="repeat one slice, CAMPAIGN:NUMBER")
    parser.add_argument("--steps", type=int, help="end a slice after so many steps")
    return parser.parse_args()


def run_slice(part: Slice) -> Record:
    """Run a slice in this process."""
    record, watch = Record(part), ResourceMonitor()
    import_module(f"soak.campaigns.{part.campaign}").run(record, watch)
    watch.check(record)
    return record


def _run_soak(seconds: float, seed: int, out: Path) -> int:
    """Run all campaigns for ``seconds``; return the exit status."""
    with ThreadPoolExecutor(len(CAMPAIGNS)) as pool:
        lanes = pool.map(partial(_run_slices, seconds=seconds, seed=seed, out=out), CAMPAIGNS)
        results = [result for lane in lanes for result in lane]
    (out / "report.json").write_text(json.dumps(results, indent=1))
    checks, broken = (
        sum((Counter(result[kind]) for result in results), Counter[str]())
        for kind in ("checks", "broken")
    )
    for oracle, meaning in ORACLES.items():
        print(f"{oracle:20} {checks[oracle]:10} checks {broken[oracle]:6} broken   {meaning}")
    for result in results:
        _print_failures(result)
    return int(bool(broken))


def _run_slices(campaign: str, seconds: float, seed: int, out: Path) -> list[dict[str, Any]]:
    """Run a campaign in slices, one after the other."""
    count = ceil(seconds / LONGEST_SLICE)
    slices = (Slice(campaign, number, seed, seconds / count) for number in range(count))
    return [_run_process(part, out) for part in slices]


def _run_process(part: Slice, out: Path) -> dict[str, Any]:
    """Run a slice in a process with its own log; a slice without a result is a failure."""
    command = [sys.executable, "-m", "soak", "--slice", part.name, "--seed", str(part.seed)]
    command += ["--minutes", str(max(part.seconds, 1.0) / 60.0), "--out", str(out)]
    file = _result_file(part, out)
    file.unlink(missing_ok=True)
    with file.with_suffix(".log").open("w") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log)
        try:
            process.wait(part.seconds + GRACE)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)  # so that it ends its own processes
            process.wait(GRACE)
    if file.exists():
        result: dict[str, Any] = json.loads(file.read_text())
        return result
    record = Record(part)
    record.check("survival", f"the slice ended with status {process.returncode}, see its log")
    return record.as_json()


def _result_file(part: Slice, out: Path) -> Path:
    return out / f"{part.campaign}-{part.number}.json"


def _print_failures(result: dict[str, Any]) -> None:
    """Print the failures of a slice, each with the command that repeats it."""
    for failure in result["failures"]:
        repeat = f"make soak SLICE={result['slice']} SEED={result['seed']} STEPS={failure['step']}"
        print(f"{failure['oracle']}: {failure['detail']} ({repeat})")


if __name__ == "__main__":
    sys.exit(main())
