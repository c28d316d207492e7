"""``furuta sweep``."""

from collections import Counter
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
    "--out", type=TABLE,
    default=Path("output/sweep.csv"),
    help="Results, one row per run; Parquet is smaller and faster to read.",
)  # fmt: skip
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

    Each run gives the same result as furuta simulate. Call an interrupted sweep again with the same
    arguments to continue it.
    """
    from furuta.lanes.batch import batch
    from furuta.studies.cluster import check_cluster, outcomes_on_cluster
    from furuta.studies.study_tables import check_table, write_runs
    from furuta.studies.sweep import Sweep, parse_swept_parameter, run
    from furuta.studies.sweep_journal import Journal
    from furuta_bringup.printing import with_progress
    from furuta_graph.settings.settings import load_settings

    swept = tuple(parse_swept_parameter(text, DEFAULT_COUNT) for text in ranges)
    sweep = Sweep(load_settings(files, assignments), swept, seconds)
    size = sweep.size()
    check_table(out)
    if scheduler:
        check_cluster()
    journal = Journal(out, sweep)
    resumed, counts = journal.count, Counter[str]()
    try:
        simulate = partial(outcomes_on_cluster, scheduler) if scheduler else batch
        results = journal.record(run(sweep, resumed, simulate))
        for _ in with_progress("sweeping", results, size, resumed, quiet=as_json):
            pass
        pairs = zip(sweep.points(), journal.results(), strict=True)
        write_runs(_counted((point | result for point, result in pairs), counts), out)
        reason = next(journal.results())["error"]
        journal.delete()
    finally:
        journal.close()
    if counts["impossible"] == counts["runs"]:
        raise ParameterError(f"no run is possible: {reason}")
    kinds = {kind: counts[kind] for kind in ("fell", "impossible")}
    show({"runs": counts["runs"], "resumed": resumed, **kinds, "file": str(out)}, as_json)


def _counted(rows: Iterable[dict[str, Any]], counts: Counter[str]) -> Iterator[dict[str, Any]]:
    """The rows, which are counted by kind on their way."""
    for row in rows:
        counts["runs"] += 1
        counts["fell"] += bool(row["fell"])
        if row["error"]:
            counts["impossible"] += 1
        yield row
