"""Runs of a study for a verb: here or on a cluster, with a progress bar."""

import sys
from collections.abc import Container, Iterable, Iterator
from typing import TypeVar

from rich.console import Console
from rich.progress import Progress

from furuta.studies.cluster import run_on_cluster
from furuta.studies.sweep import RunResult, Sweep, run_locally

Item = TypeVar("Item")


def run_sweep(sweep: Sweep, done: Container[int], scheduler: str | None) -> Iterator[RunResult]:
    """Results of the runs that are not ``done``, from this machine or a Dask cluster."""
    if scheduler is None:
        return run_locally(sweep, done)
    return run_on_cluster(sweep, done, scheduler)


def with_progress(
    title: str, items: Iterable[Item], size: int, completed: int = 0, quiet: bool = False
) -> Iterator[Item]:
    """The items, with a bar on the terminal that advances with each of them."""
    console = Console(stderr=True, quiet=quiet or not sys.stderr.isatty())
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task(title, total=size, completed=completed)
        for item in items:
            yield item
            progress.advance(task)
