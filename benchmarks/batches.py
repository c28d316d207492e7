"""Batches of closed loops on all cores: time for sixty million samples, cost and memory per run."""

from __future__ import annotations

from pathlib import Path
from resource import getpagesize
from time import perf_counter, process_time

from furuta_analysis.simulation.batch import available_cores, batch
from furuta_analysis.simulation.closed_loop import Loop
from furuta_friction.compensation import ObserverParameters
from furuta_sim.parameters import PlantParameters

RUNS, SECONDS = 2000, 30.0
FEW, MANY, SHORT = 100, 10_000, 3.0
COSTS = 3  # times that each cost is measured; the least counts, for others only ever add to it


def batches() -> dict[str, float]:
    """The paper's rig with all its sensors and the LuGre observer, another seed in every run."""
    _run(10, SHORT)
    began = perf_counter()
    _run(RUNS, SECONDS)
    wall = perf_counter() - began
    few, _ = min(_cost(FEW) for _ in range(COSTS))
    before = _resident()
    many, most = _cost(MANY)
    return {
        "batch_2000_loops_seconds": wall,
        "batch_samples_per_s": RUNS * SECONDS / PlantParameters().sample_time / wall,
        "batch_cores": available_cores(),
        "batch_cost_10000_vs_100_runs": many / few,
        "batch_memory_growth_mb": (most - before) * 1e-6,
    }


def _cost(runs: int) -> tuple[float, int]:
    """CPU time per run [s], and the most memory seen [bytes]."""
    began = process_time()
    most = _run(runs, SHORT)
    return (process_time() - began) / runs, most


def _run(runs: int, seconds: float) -> int:
    """Run a batch; returns the most memory seen [bytes]."""
    observer = ObserverParameters(compensation="lugre")
    loops = (Loop(PlantParameters(seed=seed), observer=observer) for seed in range(runs))
    most = 0
    for number, _ in enumerate(batch(loops, seconds)):
        if number % 50 == 0:
            most = max(most, _resident())
    return most


def _resident() -> int:
    """Memory of this process [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * getpagesize()
