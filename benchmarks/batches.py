"""Batches of closed loops on all cores, and their rate over that of single runs."""

from collections import deque
from collections.abc import Iterable
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

from experiment import LOOP

from furuta.lanes.batch import batch
from furuta.lanes.lanes import compile_stages
from furuta.outcomes import outcome
from furuta_friction.compensation import ObserverParameters
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop

RUNS, SECONDS = 2000, 30.0
# Loops in lanes and alone, to compare their rates; and the part of a million runs of 10 s that is
# measured and extrapolated.
LANE_RUNS, SINGLE_RUNS = 512, 8
MILLION_FROM, MILLION_SECONDS = 20_000, 10.0
# The smallest of several measurements counts, because other processes only ever add to the cost.
MEASUREMENTS = 3


def batches() -> dict[str, float]:
    """Measure the paper's rig with its sensors and the LuGre observer, with a seed per run."""
    compile_stages([_with_sensors(0)])
    wall = _seconds((_with_sensors(seed) for seed in range(RUNS)), SECONDS)
    return {
        "batch_2000_loops_seconds": wall,
        "batch_samples_per_s": RUNS * SECONDS / PlantParameters().sample_time / wall,
        **lanes(),
    }


def lanes() -> dict[str, float]:
    """Rates of batches over single runs, each per second of CPU time, measured in turns."""
    ideal = [_ideal(k) for k in range(LANE_RUNS)]
    sensors = [_with_sensors(k) for k in range(LANE_RUNS)]
    compile_stages([ideal[0], sensors[0]])
    wall = _seconds((_ideal(k) for k in range(MILLION_FROM)), MILLION_SECONDS)
    return {
        "batch_vs_single_ideal": median(_lane_ratio(ideal) for _ in range(MEASUREMENTS)),
        "batch_vs_single_sensors": median(_lane_ratio(sensors) for _ in range(MEASUREMENTS)),
        "vector_width_bits": vector_width(),
        "million_loops_seconds": wall * 1e6 / MILLION_FROM,
        "million_loops_from": MILLION_FROM,
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


def _seconds(loops: Iterable[Loop], seconds: float) -> float:
    """Time [s] to run a batch on all cores."""
    start = perf_counter()
    deque(batch(loops, seconds), maxlen=0)
    return perf_counter() - start
