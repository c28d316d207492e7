"""``furuta sweep``."""

from pathlib import Path

import click

from furuta_bringup.option_types import TABLE
from furuta_bringup.options import (
    SIMULATED_SECONDS,
    figure_option,
    json_option,
    model_options,
    option,
)
from furuta_bringup.printing import bar, show


@click.command()
@click.argument("ranges", nargs=-1, required=True, metavar="NAME=LOW:HIGH[:COUNT]|NAME=V1,V2 ...")
@option("--seconds", type=SIMULATED_SECONDS, default=60.0, help="Simulated time of each run [s].")
@option("--scheduler", metavar="ADDRESS", help="Run on the Dask cluster of this scheduler.")
@option(
    "--out",
    type=TABLE,
    default=Path("output/sweep.csv"),
    help="Results, one row per run; Parquet is smaller and faster to read.",
)
@figure_option("Draw the arm's swing over the parameters: curves, or a map over two of them.")
@model_options
@json_option
def command(
    ranges: tuple[str, ...],
    seconds: float,
    scheduler: str | None,
    out: Path,
    figure: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Simulate the closed loop for every combination of parameter values.

    Example: furuta sweep friction_observer.alpha0=0.1:0.3:50 seed=0:9

    Each run gives the same result as furuta simulate. The table appears when all are done.
    """
    from furuta import make_loop, sweep

    runs = sweep(
        ranges,
        make_loop(assignments, files=files),
        seconds,
        out=out,
        keep_runs=figure is not None,
        scheduler=scheduler,
        progress=bar("sweeping", as_json),
    )
    show(runs, as_json, figure)
