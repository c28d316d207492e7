"""``furuta compare``."""

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple

import click
from click.core import ParameterSource

from furuta.studies.comparison.candidates import STANDARD, parse_candidates
from furuta.studies.comparison.comparison import Comparison, Trials
from furuta.studies.comparison.named_rigs import named_rigs
from furuta.studies.comparison.random_rigs import (
    DISTURBANCES,
    NOMINAL,
    TUNING,
    RandomRigs,
    parse_ranges,
)
from furuta.studies.comparison.report import Report
from furuta.studies.comparison.scores import rank
from furuta.studies.comparison.tuning import TuningBudget, tune_candidates
from furuta.studies.experiments import encoder_resolution
from furuta.studies.study_tables import SUFFIXES, check_table, write_runs
from furuta_bringup.file_types import FIGURE_SUFFIXES, OutputFile
from furuta_bringup.number_types import FiniteRange
from furuta_bringup.options import (
    MEASURED_SECONDS,
    SEED,
    json_option,
    parameter_options,
    rig_option,
)
from furuta_bringup.printing import print_json
from furuta_bringup.progress import with_progress
from furuta_hw.rigs.uncertainty import CERTAIN
from furuta_model.parameters import ParameterError
from furuta_sim.settings.rigs import find_uncertain_rig, rig_file
from furuta_sim.settings.settings import Settings, load_settings, loop

# Options without effect on the named rigs.
RANDOM_ONLY = {"rigs", "vary", "disturb", "seed", "tune_budget"}


class RigOptions(NamedTuple):
    """Which rigs, and the parameters of all nodes."""

    truths: bool
    rigs: int
    vary: tuple[str, ...]
    disturb: tuple[str, ...]
    seed: int
    rig: str
    files: tuple[Path, ...]
    assignments: tuple[str, ...]

    def settings(self) -> Settings:
        """The parameters of all nodes; those of the rig's file come first."""
        files = (rig_file(self.rig), *self.files) if self.rig else self.files
        return load_settings(files, self.assignments)

    def random_rigs(self, settings: Settings) -> RandomRigs:
        """The random rigs, as uncertain as the rig's file says if it does."""
        rig, uncertainty = find_uncertain_rig(self.rig) if self.rig else (NOMINAL, CERTAIN)
        disturbances = tuple(name for name in DISTURBANCES if {name, "all"} & set(self.disturb))
        ranges = parse_ranges(self.vary)
        return RandomRigs(settings, self.rigs, self.seed, disturbances, ranges, rig, uncertainty)


def rig_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """The options of :class:`RigOptions`, passed on as the argument ``rig_options``."""

    @wraps(function)
    def command(**others: Any) -> Any:
        chosen = RigOptions(**{name: others.pop(name) for name in RigOptions._fields})
        return function(rig_options=chosen, **others)

    wrapped: Any = rig_option(parameter_options(command))
    for option in reversed(_RIG_OPTIONS):
        wrapped = option(wrapped)
    decorated: Callable[..., Any] = wrapped
    return decorated


_RIG_OPTIONS = (
    click.option("--truths", is_flag=True,
        help="Take the named rigs of docs/comparison.md, and list each."),
    click.option("--rigs", type=click.IntRange(1, 1_000_000), default=100, show_default=True,
        help="Number of random rigs."),
    click.option("--vary", multiple=True, metavar="NAME=LOW:HIGH",
        help="Let only this parameter of the plant vary, and those that the file of --rig states "
        "as uncertain; repeatable (default: friction law, friction, pendulum)."),
    click.option("--disturb", multiple=True, type=click.Choice((*DISTURBANCES, "all")),
        help="A further disturbance of random rigs; repeatable."),
    click.option("--seed", type=SEED, default=0, show_default=True,
        help="Seed of the random rigs. plant.seed is that of the sensor noise."),
)  # fmt: skip


@click.command()
@rig_options
@click.option("--candidate", "texts", multiple=True, metavar="NAME[=PARAMETER=VALUE,...]",
    help=f"A candidate by its settings, or one of {', '.join(STANDARD)}; repeatable "
    "(default: all of these).")  # fmt: skip
@click.option("--tune-budget", type=click.IntRange(0, 100_000), default=0, show_default=True,
    help="Evaluations to tune each candidate, on rigs of their own; 0: as it is set.")  # fmt: skip
@click.option("--tuning-rigs", type=click.IntRange(1, 10_000), default=10, show_default=True,
    help="Number of random rigs to tune on.")  # fmt: skip
@click.option("--seeds", type=click.IntRange(1, 1000), default=1, show_default=True,
    help="Number of seeds of the sensor noise per rig.")  # fmt: skip
@click.option("--push", "pushes", type=FiniteRange(-1e3, 1e3), multiple=True, metavar="V",
    help="Push on the arm [V] of 0.1 s, in a run of its own; repeatable.")  # fmt: skip
@click.option("--seconds", type=MEASURED_SECONDS, default=30.0, show_default=True,
    help="Simulated time of each run [s]; its second half is measured.")  # fmt: skip
@click.option("--out", "files_out", type=OutputFile(*SUFFIXES, *FIGURE_SUFFIXES), multiple=True,
    help="A table with a row per run, or a picture; repeatable.")  # fmt: skip
@json_option
@click.pass_context
def command(
    ctx: click.Context,
    rig_options: RigOptions,
    texts: tuple[str, ...],
    tune_budget: int,
    tuning_rigs: int,
    seeds: int,
    pushes: tuple[float, ...],
    seconds: float,
    files_out: tuple[Path, ...],
    as_json: bool,
) -> None:
    """Compare compensations on simulated rigs that they do not know.

    Example: furuta compare --rigs 1000 --candidate none --candidate lugre
    --candidate stiff=compensation=lugre,sigma0=1000

    A candidate keeps its values on every rig. The rigs are named ones (--truths), or as uncertain
    as the file of --rig says, or random. With --tune-budget a parameter of a candidate may have a
    range, PARAMETER=LOW:HIGH.
    """
    _check_options(ctx)
    table, pictures = _table_and_pictures(files_out)
    settings = rig_options.settings()
    candidates = parse_candidates(texts or STANDARD, settings, bool(tune_budget))
    random = rig_options.random_rigs(settings)
    tuned = []
    if tune_budget:
        rigs = replace(random, size=tuning_rigs, purpose=TUNING)
        budget = TuningBudget(tune_budget, rigs, seconds)
        results = tune_candidates(candidates, settings, budget)
        tuned = list(with_progress("tuning", results, len(candidates), quiet=as_json))
        candidates = tuple(candidate.as_candidate for candidate in tuned)
    trials = Trials(seeds, tuple(push for push in dict.fromkeys(pushes) if push), seconds)
    chosen = named_rigs(settings) if rig_options.truths else random
    comparison = Comparison(settings, chosen, candidates, trials)
    rows = with_progress("comparing", comparison.rows(), comparison.size, quiet=as_json)
    if table is not None:
        write_runs(rows, table)
    deque(rows, maxlen=0)
    outcome, count = comparison.table(), encoder_resolution(loop(settings))
    scores = rank(outcome, count)
    report = Report(outcome, scores, count, len(comparison.impossible), tuned)
    if pictures:
        _draw(report, pictures)
    if as_json:
        print_json(report.as_json(by_rig=rig_options.truths))
    else:
        report.print(by_rig=rig_options.truths)


def _check_options(ctx: click.Context) -> None:
    """Reject options that would have no effect."""
    given = {
        name for name in ctx.params if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE
    }
    if useless := given & RANDOM_ONLY if "truths" in given else ():
        name = min(useless).replace("_", "-")
        raise ParameterError(f"--{name} has no effect on the named rigs of --truths")
    if "tuning_rigs" in given and not ctx.params["tune_budget"]:
        raise ParameterError("--tuning-rigs needs --tune-budget")


def _table_and_pictures(files: tuple[Path, ...]) -> tuple[Path | None, list[Path]]:
    """The file of the rows, if one is given, and those of pictures."""
    tables = [file for file in files if file.suffix in SUFFIXES]
    if len(tables) > 1:
        raise ParameterError(f"--out: one table is enough, given {' and '.join(map(str, tables))}")
    for table in tables:
        check_table(table)
    return next(iter(tables), None), [file for file in files if file not in tables]


def _draw(report: Report, pictures: list[Path]) -> None:
    """Draw the residuals of the candidates, the best one first."""
    from furuta.figures.comparison import draw_comparison

    order = [score.candidate for score in report.scores]
    for picture in pictures:
        draw_comparison(report.table, order, report.encoder_count, picture)
