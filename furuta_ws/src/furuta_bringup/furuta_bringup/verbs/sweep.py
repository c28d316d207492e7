"""``furuta sweep``."""

from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import click

from furuta_bringup.option_types import TABLE
from furuta_bringup.options import SIMULATED_SECONDS, json_option, model_options, option
from furuta_bringup.printing import show
from furuta_model.parameters import ParameterError

DEFAULT_COUNT = 10


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
@model_options
@json_option
def command(
    ranges: tuple[str, ...],
    seconds: float,
    scheduler: str | None,
    out: Path,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Simulate the closed loop for every combination of parameter values.

    Example: furuta sweep friction_observer.alpha0=0.1:0.3:50 seed=0:9

    Each run gives the same result as furuta simulate. The table appears when all are done.
    """
    from furuta.lanes.batch import batch
    from furuta.settings.settings import load_settings
    from furuta.studies.study_tables import check_table, write_runs
    from furuta.studies.sweep import Sweep, outcomes_on_cluster, parse_swept_parameter, run
    from furuta_bringup.printing import with_progress

    swept = tuple(parse_swept_parameter(text, DEFAULT_COUNT) for text in ranges)
    sweep = Sweep(load_settings(files, assignments), swept, seconds)
    size = sweep.size()
    check_table(out)
    simulate = partial(outcomes_on_cluster, scheduler) if scheduler else batch
    results = with_progress("sweeping", run(sweep, simulate), size, quiet=as_json)
    pairs = zip(sweep.points(), results, strict=True)
    found: dict[str, Any] = {"runs": size, "fell": 0, "impossible": 0}
    reasons: list[str] = []
    write_runs(_counted((point | result for point, result in pairs), found, reasons), out)
    if found["impossible"] == size:
        raise ParameterError(f"no run is possible: {reasons[0]}")
    show(found | {"file": str(out)}, as_json)


def _counted(
    rows: Iterable[dict[str, Any]], found: dict[str, Any], reasons: list[str]
) -> Iterator[dict[str, Any]]:
    """The rows, which are counted on their way, and the first reason why one is impossible."""
    for row in rows:
        found["fell"] += bool(row["fell"])
        found["impossible"] += bool(row["error"])
        if row["error"] and not reasons:
            reasons.append(row["error"])
        yield row
