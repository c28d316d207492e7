"""``make bench``: all benchmarks in one run, written as JSON and printed as a table.

The last line printed is the path of the JSON file. Ratios are ours over theirs. Rates of the core
are per second of one core's CPU time, so that other processes do not affect them.
"""

import json
import os
from pathlib import Path

import batches
import core
import graph
from rich.console import Console
from rich.table import Table

OUT = Path("output/bench.json")
MEANING = {
    "core_vs_mujoco_python": "closed-loop samples/s, core over MuJoCo in a Python loop with numpy",
    "core_vs_mujoco_python_tuned": "the same, with the fastest Python loop found for MuJoCo",
    "batch_vs_mujoco_python": "a batch in lanes over MuJoCo in a Python loop with numpy, per core",
    "core_vs_mujoco_c": "core's closed loop over MuJoCo's C stepping alone, without feedback",
    "core_vs_scipy": "core over scipy's LSODA",
    "core_samples_per_s": "closed-loop samples/s of one core",
    "mujoco_python_samples_per_s": "MuJoCo, Python loop with numpy",
    "mujoco_python_tuned_samples_per_s": "MuJoCo, fastest Python loop",
    "mujoco_c_samples_per_s": "MuJoCo, mj_step with nstep",
    "scipy_samples_per_s": "LSODA to 1e-6, output every 1 ms",
    "amplitude_error": "limit cycle's amplitude at a 1 ms step, relative",
    "amplitude_error_mujoco": "the same, MuJoCo (Euler, the one whose speed is above)",
    "amplitude_error_mujoco_rk4": "the same, MuJoCo's RK4, a third as fast",
    "batch_2000_loops_seconds": "2000 runs of 30 s, sensors and LuGre observer, on all cores",
    "batch_samples_per_s": "the same in samples/s",
    "batch_vs_single_ideal": "samples/s per core, batch over single runs, ideal sensors",
    "batch_vs_single_sensors": "the same with sensors, Kalman filter and LuGre observer",
    "vector_width_bits": "width of the processor's vectors",
    "million_loops_seconds": "10⁶ ideal loops of 10 s on all cores, extrapolated",
    "million_loops_from": "from so many loops",
    "lockstep_vs_bare_chain": "lock-step samples/s, graph over bare chain",
    "lockstep_vs_raw_chain": "the same over a bare chain that passes serialised messages",
    "lockstep_samples_per_s": "lock-step samples/s of the graph",
    "bare_chain_samples_per_s": "lock-step samples/s of the bare chain",
    "raw_chain_samples_per_s": "the same with serialised messages",
    "latency_p50_s": "measurement to command at 1 kHz, median",
    "latency_p99_s": "measurement to command at 1 kHz, 99th percentile",
    "latency_p50_vs_bare_chain": "median latency, graph over bare chain",
    "latency_p99_vs_bare_chain": "99th percentile of the latency, graph over bare chain",
    "realtime_on_time_fraction": "1 kHz samples whose command comes before the next sample",
    "realtime_overrun_fraction": "1 kHz deadlines skipped because the process was late",
    "machine_late_fraction": "deadlines that a sleeping loop misses by more than 0.5 ms",
}


def main() -> None:
    """Run all benchmarks, print the table and write the file."""
    os.environ.setdefault("ROS_DOMAIN_ID", "101")  # not the domain of a running graph
    results = core.speed() | core.errors() | batches.batches() | graph.lockstep() | graph.realtime()
    table = Table(title="benchmarks, all in one run on this machine")
    table.add_column("figure", no_wrap=True)
    table.add_column("value", justify="right")
    table.add_column("meaning")
    for name, value in results.items():
        table.add_row(name, f"{value:.4g}", MEANING[name])
    Console().print(table)
    OUT.parent.mkdir(parents=True, exist_ok=True)
    OUT.write_text(json.dumps(results, indent=2) + "\n")
    print(OUT)


if __name__ == "__main__":
    main()
