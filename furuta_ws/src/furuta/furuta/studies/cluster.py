"""Runs of a sweep on a Dask cluster whose workers have this workspace installed."""

from collections import deque
from collections.abc import Iterator
from itertools import islice
from typing import Any

from furuta.lanes.batch import outcomes
from furuta.outcomes import Outcome
from furuta_model.accepted_parts import accept_parts, accepted_parts
from furuta_ros.errors import UserError
from furuta_sim.simulation.closed_loop import Loop

# Runs that are sent together.
CHUNK_SIZE = 8
# Chunks per thread of the cluster that are sent ahead, so that no thread is idle.
CHUNKS_PER_THREAD = 4
# Longest wait for the scheduler's answer [s].
CONNECT_TIMEOUT = 5.0
# Attempts per chunk. A cluster blames a task for every worker that dies while running it.
MAX_ATTEMPTS = 20


def check_cluster() -> None:
    """Raise ModuleNotFoundError if the package is not installed, before anything is written."""
    import distributed  # noqa: F401


def outcomes_on_cluster(address: str, loops: Iterator[Loop], seconds: float) -> Iterator[Outcome]:
    """The outcomes of loops on the cluster at ``address``, in order.

    A chunk whose worker dies is run again by another worker; finished runs are not repeated.
    """
    from distributed import Client

    try:
        client = Client(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UserError(f"no Dask scheduler answers at {address}: {error}") from None
    with client:
        chunks = iter(lambda: list(islice(loops, CHUNK_SIZE)), [])
        waiting: deque[tuple[list[Loop], Any]] = deque()
        while True:
            most = CHUNKS_PER_THREAD * max(1, sum(client.nthreads().values()))
            for chunk in islice(chunks, max(0, most - len(waiting))):
                waiting.append((chunk, _submit(client, chunk, seconds)))
            if not waiting:
                return
            yield from _outcomes(client, *waiting.popleft(), seconds)


def _submit(client: Any, chunk: list[Loop], seconds: float) -> Any:
    return client.submit(_outcomes_of, accepted_parts(), chunk, seconds, pure=False)


def _outcomes_of(parts: list[str], chunk: list[Loop], seconds: float) -> list[Outcome]:
    """The outcomes of loops whose parts the client of the cluster accepts; for its workers."""
    accept_parts(parts)
    return outcomes(chunk, seconds)


def _outcomes(client: Any, chunk: list[Loop], future: Any, seconds: float) -> list[Outcome]:
    """Wait for the outcomes of a chunk, which is submitted again if its worker died."""
    from distributed import KilledWorker

    for _ in range(MAX_ATTEMPTS):
        try:
            done: list[Outcome] = future.result()
            return done
        except KilledWorker:
            future = _submit(client, chunk, seconds)
        except (ImportError, RuntimeError) as error:
            raise UserError(f"a worker of the cluster cannot run it: {error}") from None
    raise UserError(f"{MAX_ATTEMPTS} workers died in one sweep; it can be resumed")
