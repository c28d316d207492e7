"""Simulates many closed loops on all cores.

A run is one call of compiled code that releases the interpreter lock, so threads share the work
without copies or processes. A run depends on its own parameters and seed alone: its outcome is the
same to the last bit for any other runs, any order and any number of workers.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor

from furuta_analysis.simulation.closed_loop import SETTLED, Loop, Outcome, outcome

# Pending runs per worker: enough to keep it busy, few enough to need little memory.
PENDING_PER_WORKER = 4


def batch(
    loops: Iterable[Loop], seconds: float, settled: float = SETTLED, workers: int | None = None
) -> Iterator[Outcome]:
    """Yield the outcomes of ``loops`` in order, each run for ``seconds`` from its initial state.

    The last fraction ``settled`` of every run is measured. ``loops`` is consumed step by step, so
    memory does not grow with their number. ``workers`` defaults to the number of available cores.
    """
    workers = workers or available_cores()
    pending: deque[Future[Outcome]] = deque()
    with ThreadPoolExecutor(workers) as pool:
        for loop in loops:
            pending.append(pool.submit(outcome, loop, seconds, settled))
            if len(pending) > workers * PENDING_PER_WORKER:
                yield pending.popleft().result()
        while pending:
            yield pending.popleft().result()


def outcomes(loops: Iterable[Loop], seconds: float, settled: float = SETTLED) -> list[Outcome]:
    """Outcomes of a few loops, one after the other: the unit of work on a cluster."""
    return [outcome(loop, seconds, settled) for loop in loops]


def available_cores() -> int:
    """Cores that this process may run on."""
    return len(os.sched_getaffinity(0))
