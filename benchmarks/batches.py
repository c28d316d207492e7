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
# Runs of a small and of a large batch, and their length [s], to compare the cost per run.
FEW_RUNS, MANY_RUNS, SHORT = 100, 10_000, 3.0
# The smallest of several measurements counts, because other processes only ever add to the cost.
MEASUREMENTS = 3


def batches() -> dict[str, float]:
    """Measure the paper's rig with its sensors and the LuGre observer, with a seed per run."""
    _run(10, SHORT)
    start = perf_counter()
    _run(RUNS, SECONDS)
    wall = perf_counter() - start
    few, _ = min(_cost(FEW_RUNS) for _ in range(MEASUREMENTS))
    before = _resident_memory()
    many, peak = _cost(MANY_RUNS)
    return {
        "batch_2000_loops_seconds": wall,
        "batch_samples_per_s": RUNS * SECONDS / PlantParameters().sample_time / wall,
        "batch_cores": available_cores(),
        "batch_cost_10000_vs_100_runs": many / few,
        "batch_memory_growth_mb": (peak - before) * 1e-6,
    }


def _cost(runs: int) -> tuple[float, int]:
    """CPU time per run [s] and peak memory [bytes]."""
    start = process_time()
    peak = _run(runs, SHORT)
    return (process_time() - start) / runs, peak


def _run(runs: int, seconds: float) -> int:
    """Run a batch and return the peak memory [bytes]."""
    observer = ObserverParameters(compensation="lugre")
    loops = (Loop(PlantParameters(seed=seed), observer=observer) for seed in range(runs))
    peak = 0
    for number, _ in enumerate(batch(loops, seconds)):
        if number % 50 == 0:
            peak = max(peak, _resident_memory())
    return peak


def _resident_memory() -> int:
    """Resident memory of this process [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * getpagesize()
