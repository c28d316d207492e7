"""Batches of closed loops on all cores: time for sixty million samples, cost and memory per run."""

from pathlib import Path
from resource import getpagesize
from statistics import median
from time import perf_counter, process_time

from experiment import LOOP

from furuta.lanes.batch import available_cores, batch
from furuta.lanes.lanes import compile_stages
from furuta.outcomes import outcome
from furuta_friction.compensation import ObserverParameters
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop

RUNS, SECONDS = 2000, 30.0
# Runs of a small and of a large batch, and their length [s], to compare the cost per run.
FEW_RUNS, MANY_RUNS, SHORT = 100, 10_000, 3.0
# Loops in lanes and alone, to compare their rates; and the part of a million runs of 10 s that is
# measured and extrapolated.
LANE_RUNS, SINGLE_RUNS = 512, 8
MILLION_FROM, MILLION_SECONDS = 20_000, 10.0
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
        **lanes(),
    }


def lanes() -> dict[str, float]:
    """Rates of batches over single runs, each per second of CPU time, measured in turns."""
    ideal = [_ideal(k) for k in range(LANE_RUNS)]
    sensors = [_with_sensors(k) for k in range(LANE_RUNS)]
    compile_stages([ideal[0], sensors[0]])
    million = MILLION_FROM * MILLION_SECONDS / PlantParameters().sample_time
    start = perf_counter()
    number = sum(1 for _ in batch((_ideal(k) for k in range(MILLION_FROM)), MILLION_SECONDS))
    wall = perf_counter() - start
    assert number == MILLION_FROM
    return {
        "batch_vs_single_ideal": median(_lane_ratio(ideal) for _ in range(MEASUREMENTS)),
        "batch_vs_single_sensors": median(_lane_ratio(sensors) for _ in range(MEASUREMENTS)),
        "vector_width_bits": vector_width(),
        "million_loops_seconds": wall * 1e6 / MILLION_FROM,
        "million_loops_from": MILLION_FROM,
        "million_loops_samples_per_s": million / wall,
    }


def ideal_batch_rate() -> float:
    """Samples per second of one core's CPU time, for a batch of loops with ideal sensors."""
    loops = [_ideal(k) for k in range(LANE_RUNS)]
    compile_stages(loops[:1])
    start = process_time()
    steps = sum(outcome.steps for outcome in batch(loops, SECONDS, workers=1))
    return steps / (process_time() - start)


def vector_width() -> int:
    """Bits of the widest vectors of this processor that the compiler uses."""
    flags = Path("/proc/cpuinfo").read_text()
    return 512 if " avx512f " in flags else 256 if " avx2 " in flags else 128


def _lane_ratio(loops: list[Loop]) -> float:
    start = process_time()
    alone = [outcome(loop, SECONDS) for loop in loops[:SINGLE_RUNS]]
    single = (process_time() - start) / SINGLE_RUNS
    start = process_time()
    together = list(batch(loops, SECONDS, workers=1))
    assert repr(together[:SINGLE_RUNS]) == repr(alone)
    return single / ((process_time() - start) / len(loops))


def _ideal(seed: int) -> Loop:
    """The loop of the comparison with MuJoCo, with a friction level of its own."""
    friction = LOOP.plant.friction
    level = friction.parameters._replace(alpha0=0.15 + 0.1 * (seed % 1000) / 1000)
    plant = LOOP.plant._replace(friction=friction._replace(parameters=level))
    return LOOP._replace(plant=plant)


def _with_sensors(seed: int) -> Loop:
    return Loop(PlantParameters(seed=seed), observer=ObserverParameters(compensation="lugre"))


def _cost(runs: int) -> tuple[float, int]:
    """CPU time per run [s] and peak memory [bytes]."""
    start = process_time()
    peak = _run(runs, SHORT)
    return (process_time() - start) / runs, peak


def _run(runs: int, seconds: float) -> int:
    """Run a batch and return the peak memory [bytes]."""
    loops = (_with_sensors(seed) for seed in range(runs))
    peak = 0
    for number, _ in enumerate(batch(loops, seconds)):
        if number % 50 == 0:
            peak = max(peak, _resident_memory())
    return peak


def _resident_memory() -> int:
    """Resident memory of this process [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * getpagesize()
