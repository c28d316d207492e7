"""``furuta compare``."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import click
from click.core import ParameterSource

from furuta.studies.comparison.candidates import STANDARD, parse_candidates
from furuta.studies.comparison.comparison import ROWS, Comparison, Rigs
from furuta.studies.comparison.random_rigs import DISTURBANCES, TUNING
from furuta.studies.comparison.results import Results
from furuta.studies.comparison.scores import Rows, rank, tabulate
from furuta.studies.comparison.tuning import Tuning, TuningBudget
from furuta.studies.experiments import encoder_resolution
from furuta.studies.sweep import RunResult
from furuta_bringup.comparison_report import print_report, summary_of
from furuta_bringup.number_types import FiniteRange
from furuta_bringup.options import (
    MEASURED_SECONDS,
    SEED,
    finite,
    json_option,
    model_options,
    print_json,
)
from furuta_bringup.study_runs import run_study, with_progress
from furuta_model.parameters import ParameterError
from furuta_sim.settings.settings import load_settings, loop

# Options without effect on the named rigs.
RANDOM_ONLY = ("rigs", "first_rig", "disturb")
# Pushes on the arm [V].
PUSHES = (1.0, 2.0, 3.0, 4.0)


@click.command()
@click.option("--rows", type=click.Choice(ROWS), default="named", show_default=True,
    help="Which simulated rigs: the rows of docs/comparison.md, or random ones.")  # fmt: skip
@click.option("--rigs", type=click.IntRange(1, 1_000_000), default=100, show_default=True,
    help="Number of random rigs.")  # fmt: skip
@click.option("--first-rig", type=click.IntRange(0, 1_000_000_000), default=0, show_default=True,
    help="Number of the first random rig.")  # fmt: skip
@click.option("--seed", type=SEED, default=0, show_default=True,
    help="Seed of the random rigs. plant.seed is that of the sensor noise.")  # fmt: skip
@click.option("--disturb", multiple=True, type=click.Choice((*DISTURBANCES, "all")),
    help="A further disturbance of random rigs; repeatable.")  # fmt: skip
@click.option("--seeds", type=click.IntRange(1, 1000), default=3, show_default=True,
    help="Number of seeds of the sensor noise per rig.")  # fmt: skip
@click.option("--push", "pushes", type=FiniteRange(-1e3, 1e3), multiple=True, default=PUSHES,
    show_default=True, metavar="V",
    help="Push on the arm [V] of 0.1 s, in a run of its own; repeatable; 0 for none.")  # fmt: skip
@click.option("--candidate", "texts", multiple=True, metavar="NAME[=PARAMETER=VALUE,...]",
    help=f"A candidate by its settings, or one of {', '.join(STANDARD)}; repeatable "
    "(default: all of these).")  # fmt: skip
@click.option("--tune-budget", type=click.IntRange(0, 100_000), default=0, show_default=True,
    help="Evaluations to tune each candidate, on rigs of their own; 0: as it is set.")  # fmt: skip
@click.option("--tuning-rigs", type=click.IntRange(1, 10_000), default=10, show_default=True,
    help="Number of random rigs to tune on.")  # fmt: skip
@click.option("--seconds", type=MEASURED_SECONDS, default=30.0, show_default=True,
    help="Simulated time of each run [s]; its second half is measured.")  # fmt: skip
@click.option("--scheduler", metavar="ADDRESS", help="Run on the Dask cluster of this scheduler.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), metavar="DIR",
    default=Path("output/comparison"), show_default=True,
    help="Directory of the results.")  # fmt: skip
@model_options
@json_option
@click.pass_context
def command(
    ctx: click.Context,
    rows: str,
    rigs: int,
    first_rig: int,
    seed: int,
    disturb: tuple[str, ...],
    seeds: int,
    pushes: tuple[float, ...],
    texts: tuple[str, ...],
    tune_budget: int,
    tuning_rigs: int,
    seconds: float,
    scheduler: str | None,
    out: Path,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compare compensations on simulated rigs whose friction and pendulum they do not know.

    Example: furuta compare --rows random --rigs 1000 --candidate none --candidate lugre
    --candidate stiff=compensation=lugre,sigma0=1000

    A candidate keeps its nominal values on every rig. With --tune-budget a parameter may have a
    range, PARAMETER=LOW:HIGH. Call an interrupted comparison again with the same arguments to
    continue it.
    """
    _check_options(ctx, rows, tune_budget)
    settings = load_settings(files, assignments)
    candidates = parse_candidates(texts or STANDARD, settings, bool(tune_budget))
    disturbances = tuple(name for name in DISTURBANCES if {name, "all"} & set(disturb))
    results = Results(out)
    show = partial(_show_progress, quiet=as_json)
    if tune_budget:
        tuning = Rigs("random", tuning_rigs, 0, seed, disturbances, TUNING)
        budget = TuningBudget(tune_budget, tuning, seconds)
        candidates = results.tune(Tuning(settings, candidates, budget), partial(show, "tuning"))
    chosen = Rigs(rows, rigs, first_rig, seed, disturbances)
    given = tuple(push for push in dict.fromkeys(pushes) if push)
    comparison = Comparison(settings, chosen, candidates, seeds, given, seconds)
    runs = results.run(
        comparison, partial(run_study, scheduler=scheduler), partial(show, "comparing")
    )
    _report(runs, encoder_resolution(loop(settings)), results, as_json)


def _check_options(ctx: click.Context, rows: str, tune_budget: int) -> None:
    """Reject options that would have no effect."""
    given = [
        name for name in ctx.params if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE
    ]
    for name in given:
        option = f"--{name.replace('_', '-')}"
        if name in RANDOM_ONLY and rows != "random":
            raise ParameterError(f"{option} needs --rows random")
        if name == "tuning_rigs" and not tune_budget:
            raise ParameterError(f"{option} needs --tune-budget")


def _show_progress(
    title: str, results: Iterator[RunResult], size: int, resumed: int, quiet: bool
) -> None:
    for _ in with_progress(title, results, size, resumed, quiet):
        pass


def _report(runs: Rows, encoder_count: float, results: Results, as_json: bool) -> None:
    """Write and print the scores, and draw the figure."""
    from furuta.figures.comparison import draw_comparison

    if all(row["error"] for row in runs):
        raise ParameterError(f"no run is possible: {runs[0]['error']}")
    table = tabulate(runs)
    scores = rank(table, encoder_count)
    summary = summary_of(scores, table, encoder_count)
    results.write_summary(finite(summary))
    draw_comparison(table, [each.candidate for each in scores], encoder_count, results.figure)
    if as_json:
        print_json(summary)
    else:
        print_report(scores, table, encoder_count)
        print(f"results: {results.directory}")
