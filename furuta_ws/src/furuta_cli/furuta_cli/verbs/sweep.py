"""``furuta sweep``."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
from rich.console import Console
from rich.progress import Progress

from furuta_cli.file_types import FIGURE
from furuta_cli.options import SEED, SIMULATED_SECONDS, json_option, model_options, print_json
from furuta_graph.settings import load_settings
from furuta_model.parameters import ParameterError
from furuta_studies.sweep import RunResult, Sweep, run_locally
from furuta_studies.sweep_journal import Journal, write_table
from furuta_studies.sweep_points import MAX_POINTS, METHODS, parse_swept_parameter

DEFAULT_COUNT = 10


@click.command()
@click.argument("ranges", nargs=-1, required=True, metavar="NAME=LOW:HIGH[:COUNT]|NAME=V1,V2 ...")
@click.option("--method", type=click.Choice(METHODS), default="grid", show_default=True,
    help="How points are chosen: every combination, or a sample.")  # fmt: skip
@click.option(
    "--points",
    type=click.IntRange(1, MAX_POINTS),
    default=256,
    show_default=True,
    help="Number of runs with random or sobol.",
)
@click.option(
    "--seed",
    type=SEED,
    default=0,
    show_default=True,
    help="Seed of random and sobol points. plant.seed is that of the sensor noise.",
)
@click.option(
    "--seconds",
    type=SIMULATED_SECONDS,
    default=60.0,
    show_default=True,
    help="Simulated time of each run [s].",
)
@click.option("--scheduler", metavar="ADDRESS", help="Run on the Dask cluster of this scheduler.")
@click.option(
    "--out", type=click.Path(path_type=Path), metavar="FILE.csv", default=Path("output/sweep.csv"),
    show_default=True, help="Results, one row per run.",
)  # fmt: skip
@click.option("--picture", type=FIGURE, metavar="FILE.png", help="Draw the results.")
@model_options
@json_option
def command(
    ranges: tuple[str, ...],
    method: str,
    points: int,
    seed: int,
    seconds: float,
    scheduler: str | None,
    out: Path,
    picture: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Simulate the closed loop for many parameter values.

    Example: furuta sweep friction_observer.alpha0=0.1:0.3:50 seed=0:9

    Each run gives the same result as furuta simulate. Call an interrupted sweep again with the same
    arguments to continue it.
    """
    if out.suffix != ".csv":
        raise ParameterError(f"--out must be a .csv file, given {out}")
    if out.exists():
        raise ParameterError(f"{out} already exists; name another file with --out")
    swept = tuple(parse_swept_parameter(each, DEFAULT_COUNT) for each in ranges)
    sweep = Sweep(load_settings(files, assignments), swept, method, points, seed, seconds)
    size = sweep.size
    journal = Journal(out, sweep)
    resumed = len(journal.results)
    try:
        results = _run(sweep, set(journal.results), scheduler)
        _show_progress(journal.record(results), size, resumed, as_json)
    finally:
        journal.close()
    rows = [point | journal.results[number] for number, point in enumerate(sweep.generate_points())]
    write_table(rows, out)
    journal.delete()
    if picture is not None:
        from furuta_figures.sweep import draw_sweep

        draw_sweep(swept, rows, picture)
    _report(rows, resumed, out, as_json)


def _run(sweep: Sweep, done: set[int], scheduler: str | None) -> Iterator[RunResult]:
    if scheduler is None:
        return run_locally(sweep, done)
    from furuta_studies.cluster import run_on_cluster

    return run_on_cluster(sweep, done, scheduler)


def _show_progress(results: Iterator[RunResult], size: int, resumed: int, quiet: bool) -> None:
    console = Console(stderr=True, quiet=quiet or not sys.stderr.isatty())
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("sweeping", total=size, completed=resumed)
        for _ in results:
            progress.advance(task)


def _report(rows: list[dict[str, Any]], resumed: int, out: Path, as_json: bool) -> None:
    impossible = sum(bool(row["error"]) for row in rows)
    summary = {
        "runs": len(rows),
        "resumed": resumed,
        "fell": sum(bool(row["fell"]) for row in rows),
        "impossible": impossible,
        "file": str(out),
    }
    if impossible == len(rows):
        raise ParameterError(f"no run is possible: {rows[0]['error']}")
    if as_json:
        print_json(summary)
    else:
        for name, value in summary.items():
            print(f"{name:24} {value}")
