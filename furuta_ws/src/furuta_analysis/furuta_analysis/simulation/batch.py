"""Many closed loops on all cores.

A run is one call of compiled code that frees the interpreter, so threads share the work without
copies or processes. Each run depends on its own parameters and seed alone: its outcome is the
same, to the last bit, whatever runs beside it, in whatever order and on however many workers.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor

from furuta_analysis.simulation.closed_loop import SETTLED, Loop, Outcome, outcome

# Runs per worker that wait for it: enough to keep it busy, and all that memory has to hold.
WAITING = 4


def batch(
    loops: Iterable[Loop], seconds: float, settled: float = SETTLED, workers: int | None = None
) -> Iterator[Outcome]:
    """Outcomes of ``loops``, in their order, each run for ``seconds`` from its initial state.

    The last part ``settled`` of every run is measured. ``loops`` is drawn on as the work goes, so
    memory does not grow with their number; ``workers`` defaults to the cores this process may use.
    """
    workers = workers or available_cores()
    under_way: deque[Future[Outcome]] = deque()
    with ThreadPoolExecutor(workers) as pool:
        for loop in loops:
            under_way.append(pool.submit(outcome, loop, seconds, settled))
            if len(under_way) > workers * WAITING:
                yield under_way.popleft().result()
        while under_way:
            yield under_way.popleft().result()


def outcomes(loops: Iterable[Loop], seconds: float, settled: float = SETTLED) -> list[Outcome]:
    """The same of a few loops, one after the other: a cluster's unit of work."""
    return [outcome(loop, seconds, settled) for loop in loops]


def available_cores() -> int:
    """Cores that this process may run on."""
    return len(os.sched_getaffinity(0))
