"""``furuta robustness``."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from time import perf_counter
from typing import Any

import click
import numpy as np

from furuta.studies.experiments import encoder_resolution
from furuta.studies.robustness.robustness import (
    RigStudy,
    Robustness,
    Sensitivity,
    residual,
    robustness,
    sobol,
)
from furuta.studies.study_tables import SUFFIXES, check_table, write_runs
from furuta.studies.sweep_journal import Journal
from furuta_bringup.file_types import FIGURE_SUFFIXES, OutputFile
from furuta_bringup.number_types import FiniteRange
from furuta_bringup.options import MEASURED_SECONDS, SEED, json_option, print_json
from furuta_bringup.study_runs import progress_bar, run_study, with_progress
from furuta_bringup.uncertain_rig_options import RigOptions, uncertain_rig_options
from furuta_model.parameters import ParameterError

MAX_RIGS = 10_000_000


@click.command()
@click.argument("ranges", nargs=-1, metavar="[NAME=LOW:HIGH ...]")
@click.option("--rigs", type=click.IntRange(1, MAX_RIGS), default=1000, show_default=True,
    help="Number of rigs.")  # fmt: skip
@click.option(
    "--bound",
    type=FiniteRange(0, min_open=True),
    metavar="RAD",
    help="Largest residual that counts as within; default: one count of the encoder.",
)
@click.option("--seconds", type=MEASURED_SECONDS, default=20.0, show_default=True,
    help="Simulated time of each run [s].")  # fmt: skip
@click.option("--seed", type=SEED, default=0, show_default=True, help="Seed of the rigs.")
@click.option("--sobol", "points", type=click.IntRange(2, 2**20), metavar="N",
    help="Compute Sobol indices with N points, a power of two.")  # fmt: skip
@click.option("--scheduler", metavar="ADDRESS", help="Run on the Dask cluster of this scheduler.")
@click.option(
    "--out",
    "files_out",
    type=OutputFile(*SUFFIXES, *FIGURE_SUFFIXES),
    multiple=True,
    metavar="FILE",
    help="A .csv or .parquet file for a row per rig, with which an interrupted study can continue; "
    "or a .png file for a picture over the two values that matter most; repeatable.",
)
@uncertain_rig_options
@json_option
def command(
    ranges: tuple[str, ...],
    rigs: int,
    bound: float | None,
    seconds: float,
    seed: int,
    points: int | None,
    scheduler: str | None,
    files_out: tuple[Path, ...],
    rig_options: RigOptions,
    as_json: bool,
) -> None:
    """Measure how sure a compensation is over rigs that are known only roughly.

    Each parameter of the simulated rig is anywhere in its range; or the rig is as uncertain as the
    file of --rig says. Estimator, friction observer and controller keep their values. Prints the
    probability that the arm's residual peak-to-peak angle stays within the bound, with its 95 %
    confidence interval.

    Example: furuta robustness alpha0=0.15:0.3 --rigs 10000 --set compensation=lugre

    Call an interrupted study with a table again with the same arguments to continue it.
    """
    if points is not None and points & (points - 1):
        raise ParameterError(f"--sobol must be a power of two, given {points}")
    table, pictures = _table_and_pictures(files_out)
    began = perf_counter()
    uncertain = rig_options.uncertain_rigs(ranges)
    if pictures and len(uncertain.names) < 2:
        raise ParameterError("a picture shows two parameters: more than one must be uncertain")
    bound = bound or encoder_resolution(uncertain.nominal) or 2.0 * np.pi / 250
    study = RigStudy(uncertain, rigs, seed, seconds)
    journal = None if table is None else Journal(table, study)
    try:
        found, resumed = _residuals(study, journal, scheduler, as_json)
        indices = _sobol(study, points, as_json) if points else []
        for picture in pictures:
            _draw(study, found, indices, bound, picture)
        if journal is not None and table is not None:
            write_runs(_rows(study, journal), table)
            journal.delete()
    finally:
        if journal is not None:
            journal.close()
    summary = _summary(robustness(found, bound), bound, study, indices)
    summary |= {"resumed": resumed, "wall_seconds": perf_counter() - began}
    if table is not None:
        summary["file"] = str(table)
    if as_json:
        print_json(summary)
    else:
        _print(summary)


def _table_and_pictures(files: tuple[Path, ...]) -> tuple[Path | None, list[Path]]:
    """The file of the rows, if one is given, and those of pictures."""
    tables = [each for each in files if each.suffix in SUFFIXES]
    if len(tables) > 1:
        raise ParameterError(f"--out: one table is enough, given {' and '.join(map(str, tables))}")
    for each in tables:
        check_table(each)
    return next(iter(tables), None), [each for each in files if each not in tables]


def _residuals(
    study: RigStudy, journal: Journal | None, scheduler: str | None, quiet: bool
) -> tuple[np.ndarray, int]:
    """The residuals of all rigs [rad], and how many had been computed before an interruption."""
    found, resumed = np.empty(study.size), 0
    if journal is not None:
        resumed = len(journal)
        for number in journal:
            found[number] = residual(journal[number])
    results = run_study(study, () if journal is None else journal, scheduler)
    if journal is not None:
        results = journal.record(results)
    for number, result in with_progress("simulating", results, study.size, resumed, quiet):
        found[number] = residual(result)
    return found, resumed


def _sobol(study: RigStudy, points: int, quiet: bool) -> list[Sensitivity]:
    total = points * (len(study.rigs.names) + 2)
    with progress_bar("Sobol indices", total, quiet=quiet) as advance:
        return sobol(study.rigs, points, study.seed, study.seconds, advance)


def _rows(study: RigStudy, journal: Journal) -> Iterator[dict[str, Any]]:
    """A row per rig: its uncertain values, and the outcome."""
    for number, values in enumerate(study.values()):
        yield {"rig": number, **values, **journal[number]}


def _summary(
    found: Robustness, bound: float, study: RigStudy, indices: list[Sensitivity]
) -> dict[str, Any]:
    return {
        "runs": found.runs,
        "bound_rad": bound,
        "within_bound": found.within_bound.value,
        "within_bound_low": found.within_bound.low,
        "within_bound_high": found.within_bound.high,
        "fell": found.falls,
        "fell_low": found.fell.low,
        "fell_high": found.fell.high,
        "p95_rad": found.p95_rad,
        "p95_low_rad": found.p95_low_rad,
        "p95_high_rad": found.p95_high_rad,
        "worst_rad": found.worst_rad,
        "uncertain": {name: list(limits) for name, limits in study.rigs.ranges.items()},
        "standard_errors": study.rigs.uncertainty.standard_errors,
        "sobol": [each._asdict() for each in indices],
    }


def _print(summary: dict[str, Any]) -> None:
    for name, value in summary.items():
        if name == "sobol":
            for each in value:
                first, total = each["first_order"], each["total"]
                print(f"sobol {each['parameter']:18} alone {first:.3f}, in all {total:.3f}")
        elif name == "uncertain":
            for parameter, (low, high) in value.items():
                print(f"uncertain {parameter:14} {low:.5g} to {high:.5g}")
        elif name == "standard_errors":
            for parameter, error in value.items():
                print(f"standard error {parameter:9} {error:.5g}")
        else:
            print(f"{name:24} {value if isinstance(value, str) else f'{value:.5g}'}")


def _draw(
    study: RigStudy, found: np.ndarray, indices: list[Sensitivity], bound: float, out: Path
) -> None:
    from furuta.figures.robustness import MOST_POINTS, draw_robustness

    names = study.rigs.names
    values = np.array([list(each.values()) for each in islice(study.values(), MOST_POINTS)])
    found = found[: len(values)]
    weights = [each.total for each in indices] or _rank_correlations(values, found)
    first, second = sorted(int(each) for each in np.argsort(weights)[::-1][:2])
    draw_robustness((names[first], names[second]), values[:, [first, second]], found, bound, out)


def _rank_correlations(values: np.ndarray, found: np.ndarray) -> list[float]:
    """Size of the correlation of each value with the rank of the residual."""
    ranks = np.argsort(np.argsort(found))
    return [abs(float(np.corrcoef(column, ranks)[0, 1])) for column in values.T]
