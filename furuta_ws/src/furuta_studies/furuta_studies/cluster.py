"""A study's runs on a Dask cluster, whose workers have this workspace installed."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

from furuta_analysis.simulation.batch import outcomes
from furuta_analysis.simulation.closed_loop import Loop
from furuta_ros.errors import UserError
from furuta_studies.sweep import Result, Study, failed, succeeded

CHUNK = 8  # runs that travel together
WAITING = 4  # chunks per thread of the cluster that are under way
CONNECT = 5.0  # [s] that the scheduler gets to answer
# Times that a chunk is tried. A cluster blames a task for every worker that dies under it.
TRIES = 20


def run_there(study: Study, done: set[int], address: str) -> Iterator[Result]:
    """Results of the runs that are not ``done``, as they come, from the cluster at ``address``.

    Chunks of a worker that dies are run again by others; runs whose results have come are not.
    """
    from distributed import Client, KilledWorker, as_completed  # noqa: PLC0415 - slow to load

    try:
        client = Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UserError(f"no Dask scheduler answers at {address}: {error}") from None
    with client:
        runs = study.loops(done)
        under_way: dict[Any, tuple[list[tuple[int, Loop]], int]] = {}
        completed = as_completed(loop=client.loop)

        def submit(chunk: list[tuple[int, Loop]], tries: int) -> None:
            loops = [made for _, made in chunk]
            future = client.submit(outcomes, loops, study.seconds, pure=False)
            under_way[future] = chunk, tries
            completed.add(future)

        while True:
            room = WAITING * max(1, sum(client.nthreads().values())) - len(under_way)
            for _ in range(room):
                given = list(islice(runs, CHUNK))
                yield from (failed(number, made) for number, made in given if isinstance(made, str))
                chunk = [(number, made) for number, made in given if not isinstance(made, str)]
                if chunk:
                    submit(chunk, 1)
                elif not given:
                    break
            if not under_way:
                return
            future = next(completed)
            chunk, tries = under_way.pop(future)
            try:
                found = future.result()
            except KilledWorker:
                if tries == TRIES:
                    raise UserError(
                        f"{TRIES} workers died in one study; it can be resumed"
                    ) from None
                submit(chunk, tries + 1)
                continue
            except (ImportError, RuntimeError) as error:
                raise UserError(f"a worker of the cluster cannot run it: {error}") from None
            for (number, _), outcome in zip(chunk, found, strict=True):
                yield succeeded(number, outcome)
