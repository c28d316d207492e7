"""``make bench``: every figure measured side by side in one run; the last line names the JSON."""

from __future__ import annotations

import json
import os
from pathlib import Path

import graph
from rich.console import Console
from rich.table import Table

OUT = Path("output/bench.json")
MEANING = {
    "lockstep_vs_bare_chain": "lock-step samples/s, graph over bare chain",
    "lockstep_samples_per_s": "lock-step samples/s of the graph",
    "bare_chain_samples_per_s": "lock-step samples/s of the bare chain",
    "latency_p50_s": "measurement to command at 1 kHz, median",
    "latency_p99_s": "measurement to command at 1 kHz, 99 %",
    "latency_p50_vs_bare_chain": "median latency, graph over bare chain",
    "latency_p99_vs_bare_chain": "99 % latency, graph over bare chain",
    "realtime_on_time_fraction": "1 kHz samples commanded before the next one",
    "realtime_overrun_fraction": "1 kHz deadlines passed over because the process came late",
    "machine_late_fraction": "deadlines that a bare sleeping loop meets over 0.5 ms late",
}


def main() -> None:
    """Measure, print, write."""
    os.environ.setdefault("ROS_DOMAIN_ID", "101")  # apart from a graph of the user's
    figures = graph.lockstep() | graph.realtime()
    table = Table(title="benchmarks, all in one run on this machine")
    table.add_column("figure", no_wrap=True)
    table.add_column("value", justify="right")
    table.add_column("meaning")
    for name, value in figures.items():
        table.add_row(name, f"{value:.4g}", MEANING[name])
    Console().print(table)
    OUT.parent.mkdir(parents=True, exist_ok=True)
    OUT.write_text(json.dumps(figures, indent=2) + "\n")
    print(OUT)


if __name__ == "__main__":
    main()
