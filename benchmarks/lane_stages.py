"""The price list of docs/speed.md: what a stage of a sample costs in lanes.

    nice -n -10 tools/in_environment python benchmarks/lane_stages.py

Each stage runs by itself, again and again, on a block of loops that have settled; the fastest of
many repetitions counts, because other processes only ever add to the cost. A stage that runs again
on the same data costs what it costs in a run, except that its data is in the cache.
"""

from collections.abc import Callable
from time import perf_counter

import numpy as np
from batches import _ideal, _with_sensors

from furuta_sim.lanes.lane_stages import PARTS
from furuta_sim.lanes.lanes import (
    block_of,
    compile_stages,
    prepare,
    run_stages,
    stage_address,
)
from furuta_sim.simulation.closed_loop import Loop, outcome

SETTLED_SAMPLES, SAMPLES, REPETITIONS = 2000, 200, 300


def main() -> None:
    """Print nanoseconds per sample and lane of every stage, and of a single run."""
    for name, make in (("ideal sensors", _ideal), ("sensors, LuGre", _with_sensors)):
        print(name)
        for stage, cost in stage_costs(make).items():
            print(f"  {stage:16} {cost:7.2f} ns")


def stage_costs(make: Callable[[int], Loop]) -> dict[str, float]:
    """Nanoseconds per sample and lane by stage, for the loop that is made from each seed."""
    compile_stages([make(0)])
    first = prepare(make(0), 10.0)
    assert first is not None
    group = first.group
    ready = [prepared for k in range(group.width) if (prepared := prepare(make(k), 10.0))]
    block = block_of(ready)
    rows = block.rows("noise")[:, : group.width]
    generator = np.random.default_rng(0)
    noise = generator.standard_normal((group.width, SETTLED_SAMPLES, len(rows)))
    addresses = {stage: stage_address(stage, group) for part in PARTS for stage in part}

    def run(stages: list[int], samples: int) -> None:
        run_stages(np.array([stages] * 3), block.address, rows, noise, 0, samples, samples)

    run([addresses[stage] for stage in PARTS[0]], SETTLED_SAMPLES)
    empty = _fastest(lambda: run([0], SAMPLES))
    per_lane = 1e9 / (SAMPLES * group.width)
    costs = {
        "noise": _fastest(lambda: generator.standard_normal(out=noise[:, :SAMPLES].copy()))
        * per_lane,
        "noise to block": empty * per_lane,
    }
    for stage, address in addresses.items():
        spent = _fastest(lambda: run([address], SAMPLES)) - empty  # noqa: B023 - called at once
        costs[stage.function.__name__] = spent * per_lane
    single = _fastest(lambda: outcome(make(0), 1.0), REPETITIONS // 10)
    return costs | {"single run": single * 1e9 / 1000}


def _fastest(action: Callable[[], object], repetitions: int = REPETITIONS) -> float:
    """The shortest time of the action [s]."""
    times = []
    for _ in range(repetitions):
        start = perf_counter()
        action()
        times.append(perf_counter() - start)
    return min(times)


if __name__ == "__main__":
    main()
