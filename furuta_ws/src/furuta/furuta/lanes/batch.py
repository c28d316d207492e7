"""Simulates many closed loops on all cores, side by side where they compute alike.

Loops of one kind run together in lanes (:mod:`furuta.lanes.lanes`), the others
singly. Both are calls of compiled code that release the interpreter lock, so threads share the work
without copies or processes. A run depends on its own parameters and seed alone: its outcome is the
same to the last bit for any other runs, any order, any number of workers, in a lane or alone.
"""

import os
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from itertools import islice

from furuta.lanes.lanes import (
    WIDTH_WITHOUT_FILTER,
    Group,
    PreparedLoop,
    is_compiled,
    prepare,
    run_block,
)
from furuta.outcomes import SETTLED, Outcome, outcome
from furuta_sim.simulation.closed_loop import Loop

# Blocks per worker that are taken from the loops together. More loops find more of their kind;
# fewer need less memory.
BLOCKS_PER_WORKER = 2
# Fewer loops of a group run singly: that is faster than a block with so many lanes to spare.
FEWEST_IN_BLOCK = 8
# Loops that one job runs singly: few, so that all cores end together.
RUNS_PER_JOB = 4
# Samples after which compiling the stages of a group takes less time than running singly.
WORTH_COMPILING = 50_000_000

_samples_run_singly: dict[Group, int] = {}


def batch(
    loops: Iterable[Loop], seconds: float, settled: float = SETTLED, workers: int | None = None
) -> Iterator[Outcome]:
    """Yield the outcomes of ``loops`` in order, each run for ``seconds`` from its initial state.

    The last fraction ``settled`` of every run is measured. ``loops`` is consumed step by step, in
    chunks that grow, so memory does not grow with their number. ``workers`` defaults to the number
    of available cores.
    """
    workers = workers or available_cores()
    pending: deque[_Chunk] = deque()
    with ThreadPoolExecutor(workers) as pool:
        for chunk in _chunks(loops, workers, workers * BLOCKS_PER_WORKER * WIDTH_WITHOUT_FILTER):
            pending.append(_Chunk(pool, chunk, seconds, settled))
            if len(pending) > 1:
                yield from pending.popleft().outcomes()
        while pending:
            yield from pending.popleft().outcomes()


def outcomes(loops: Iterable[Loop], seconds: float, settled: float = SETTLED) -> list[Outcome]:
    """Outcomes of a few loops on one core: the unit of work on a cluster."""
    return list(batch(loops, seconds, settled, workers=1))


def available_cores() -> int:
    """Cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1  # macOS and Windows bind no process to cores


def _chunks(loops: Iterable[Loop], smallest: int, largest: int) -> Iterator[list[Loop]]:
    """Take loops in chunks: small ones at first, so that the first outcomes come soon."""
    iterator, size = iter(loops), smallest
    while chunk := list(islice(iterator, size)):
        yield chunk
        size = min(2 * size, largest)


class _Chunk:
    """Some loops that are submitted together."""

    def __init__(self, pool: Executor, loops: list[Loop], seconds: float, settled: float) -> None:
        self._size = len(loops)
        self._jobs: list[tuple[list[int], Future[list[Outcome]]]] = []
        groups: dict[Group, Members] = {}
        alone = []
        for number, loop in enumerate(loops):
            prepared = prepare(loop, seconds)
            if prepared is None:
                alone.append(number)
            else:
                groups.setdefault(prepared.group, []).append((number, prepared))
        for group, members in groups.items():
            blocks, rest = _split(group, members)
            alone += [number for number, _ in rest]
            for block in blocks:
                job = pool.submit(run_block, [each for _, each in block], settled)
                self._jobs.append(([number for number, _ in block], job))
        for first in range(0, len(alone), RUNS_PER_JOB):
            numbers = alone[first : first + RUNS_PER_JOB]
            job = pool.submit(_run_singly, [loops[each] for each in numbers], seconds, settled)
            self._jobs.append((numbers, job))

    def outcomes(self) -> list[Outcome]:
        """The outcomes in the order of the loops."""
        found: dict[int, Outcome] = {}
        for numbers, job in self._jobs:
            found.update(zip(numbers, job.result(), strict=True))
        return [found[number] for number in range(self._size)]


def _run_singly(loops: list[Loop], seconds: float, settled: float) -> list[Outcome]:
    return [outcome(loop, seconds, settled) for loop in loops]


Members = list[tuple[int, PreparedLoop]]


def _split(group: Group, members: Members) -> tuple[list[Members], Members]:
    """Blocks of loops that run in lanes, and the loops that run singly."""
    if len(members) < FEWEST_IN_BLOCK or not _use_lanes(group, len(members)):
        return [], members
    width = group.width
    blocks = [members[first : first + width] for first in range(0, len(members), width)]
    rest = blocks.pop() if len(blocks[-1]) < FEWEST_IN_BLOCK else []
    return blocks, rest


def _use_lanes(group: Group, runs: int) -> bool:
    """Whether the group's stages are compiled, or compiling them is worth it by now."""
    so_far = _samples_run_singly.get(group, 0)
    if so_far > WORTH_COMPILING or is_compiled(group):
        return True
    _samples_run_singly[group] = so_far + runs * group.samples
    return False
