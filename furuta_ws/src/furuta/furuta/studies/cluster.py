"""Runs of a sweep on a Dask cluster whose workers have this workspace installed."""

from collections.abc import Container, Iterator
from itertools import islice
from typing import Any

from furuta.studies.sweep import RunResult, Sweep, finished_run, impossible_run
from furuta_ros.errors import UserError
from furuta_sim.lanes.batch import outcomes
from furuta_sim.simulation.closed_loop import Loop

# Runs that are sent together.
CHUNK_SIZE = 8
# Chunks per thread of the cluster that are sent ahead.
CHUNKS_PER_THREAD = 4
# Longest wait for the scheduler's answer [s].
CONNECT_TIMEOUT = 5.0
# Attempts per chunk. A cluster blames a task for every worker that dies while running it.
MAX_ATTEMPTS = 20

Chunk = list[tuple[int, Loop]]


def run_on_cluster(sweep: Sweep, done: Container[int], address: str) -> Iterator[RunResult]:
    """Run what is not ``done`` on the cluster at ``address``, and yield results as they arrive.

    A chunk whose worker dies is run again by another worker; finished runs are not repeated.
    """
    from distributed import Client

    try:
        client = Client(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UserError(f"no Dask scheduler answers at {address}: {error}") from None
    with client:
        yield from _ClusterRun(client, sweep, done).results()


class _ClusterRun:
    """Keeps enough chunks waiting on the cluster that no thread is idle."""

    def __init__(self, client: Any, sweep: Sweep, done: Container[int]) -> None:
        from distributed import as_completed

        self._client = client
        self._seconds = sweep.seconds
        self._remaining = sweep.remaining_loops(done)
        self._waiting: dict[Any, tuple[Chunk, int]] = {}
        self._completed = as_completed(loop=client.loop)

    def results(self) -> Iterator[RunResult]:
        while True:
            yield from self._submit_chunks()
            if not self._waiting:
                return
            yield from self._next_results()

    def _submit_chunks(self) -> Iterator[RunResult]:
        """Fill the cluster up; yields the runs that are impossible."""
        threads = max(1, sum(self._client.nthreads().values()))
        for _ in range(CHUNKS_PER_THREAD * threads - len(self._waiting)):
            taken = list(islice(self._remaining, CHUNK_SIZE))
            yield from (impossible_run(number, it) for number, it in taken if isinstance(it, str))
            chunk = [(number, it) for number, it in taken if not isinstance(it, str)]
            if chunk:
                self._submit(chunk, attempt=1)
            elif not taken:
                break

    def _submit(self, chunk: Chunk, attempt: int) -> None:
        loops = [loop for _, loop in chunk]
        future = self._client.submit(outcomes, loops, self._seconds, pure=False)
        self._waiting[future] = chunk, attempt
        self._completed.add(future)

    def _next_results(self) -> Iterator[RunResult]:
        """The results of the next chunk; a chunk whose worker died is submitted again."""
        from distributed import KilledWorker

        future = next(self._completed)
        chunk, attempt = self._waiting.pop(future)
        try:
            chunk_outcomes = future.result()
        except KilledWorker:
            if attempt == MAX_ATTEMPTS:
                raise UserError(
                    f"{MAX_ATTEMPTS} workers died in one sweep; it can be resumed"
                ) from None
            self._submit(chunk, attempt + 1)
            return
        except (ImportError, RuntimeError) as error:
            raise UserError(f"a worker of the cluster cannot run it: {error}") from None
        for (number, _), outcome in zip(chunk, chunk_outcomes, strict=True):
            yield finished_run(number, outcome)
