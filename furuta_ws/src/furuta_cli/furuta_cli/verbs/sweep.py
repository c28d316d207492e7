"""``furuta sweep``."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
from rich.console import Console
from rich.progress import Progress

from furuta_cli.options import SEED, SIMULATED_SECONDS, json_option, model_options, print_json
from furuta_graph.settings import load_settings
from furuta_model.parameters import ParameterError
from furuta_studies.sweep import Journal, Result, Study, run_here, write_table
from furuta_studies.sweep_points import METHODS, MOST_POINTS, parse_axis

COUNT = 10


@click.command()
@click.argument("ranges", nargs=-1, required=True, metavar="NAME=LOW:HIGH[:COUNT]|NAME=V1,V2 ...")
@click.option("--method", type=click.Choice(METHODS), default="grid", show_default=True)
@click.option(
    "--points",
    type=click.IntRange(1, MOST_POINTS),
    default=256,
    show_default=True,
    help="Number of runs (random and sobol).",
)
@click.option(
    "--seed",
    type=SEED,
    default=0,
    show_default=True,
    help="Seed of the points; that of the noise is the parameter plant.seed.",
)
@click.option(
    "--seconds",
    type=SIMULATED_SECONDS,
    default=60.0,
    show_default=True,
    help="Pendulum time of a run.",
)
@click.option("--scheduler", metavar="ADDRESS", help="Run on the Dask cluster of this scheduler.")
@click.option(
    "--out", type=click.Path(path_type=Path), metavar="FILE.csv", default=Path("output/sweep.csv"),
    show_default=True, help="Results, a row per run.",
)  # fmt: skip
@click.option("--picture", type=click.Path(path_type=Path), metavar="FILE.png", help="Draw them.")
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
    """Simulate the loop over any parameters, as in friction_observer.alpha0=0.1:0.3:50 seed=0:9.

    Every run equals that of furuta simulate. An interrupted sweep resumes when it is called again
    with the same arguments.
    """
    if out.suffix != ".csv":
        raise ParameterError(f"--out must be a .csv file, given {out}")
    if out.exists():
        raise ParameterError(f"{out} exists already; name another file with --out")
    axes = tuple(parse_axis(each, COUNT) for each in ranges)
    study = Study(load_settings(files, assignments), axes, method, points, seed, seconds)
    size = study.size
    journal = Journal(out, study)
    before = len(journal.results)
    try:
        results = _run(study, set(journal.results), scheduler)
        _follow(journal.keep(results), size, before, as_json)
    finally:
        journal.close()
    rows = [point | journal.results[number] for number, point in enumerate(study.design())]
    write_table(rows, out)
    journal.finish()
    if picture is not None:
        from furuta_figures.sweep import draw

        draw(axes, rows, picture)
    _report(rows, before, out, as_json)


def _run(study: Study, done: set[int], scheduler: str | None) -> Iterator[Result]:
    if scheduler is None:
        return run_here(study, done)
    from furuta_studies.cluster import run_there

    return run_there(study, done, scheduler)


def _follow(results: Iterator[Result], size: int, before: int, quiet: bool) -> None:
    console = Console(stderr=True, quiet=quiet or not sys.stderr.isatty())
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("sweeping", total=size, completed=before)
        for _ in results:
            progress.advance(task)


def _report(rows: list[dict[str, Any]], before: int, out: Path, as_json: bool) -> None:
    impossible = sum(bool(row["error"]) for row in rows)
    summary = {
        "runs": len(rows),
        "resumed": before,
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
