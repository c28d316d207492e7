"""``furuta compare``."""

from __future__ import annotations

from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from furuta.settings.settings import load_settings, loop
from furuta.studies.comparison.candidates import STANDARD, bandwidth_candidates, parse_candidates
from furuta.studies.comparison.rigs import (
    DISTURBANCES,
    MOST_RIGS,
    NOMINAL,
    RandomRigs,
    named_rigs,
)
from furuta_bringup.option_types import FIGURE_SUFFIXES, FiniteRange, OutputFile
from furuta_bringup.options import (
    MEASURED_SECONDS,
    SEED,
    json_option,
    option,
    parameter_options,
    rig_option,
)
from furuta_bringup.printing import print_json, show
from furuta_hw.rigs.known_rigs import rig_file
from furuta_hw.rigs.rig_file import load_uncertain_rig
from furuta_hw.rigs.uncertainty import CERTAIN
from furuta_model.parameters import ParameterError
from furuta_recordings.suffixes import TABLE_SUFFIXES

if TYPE_CHECKING:
    from furuta.studies.comparison.comparison import Table

# Options without effect on the named rigs.
RANDOM_ONLY = ("--rigs", "--disturb", "--seed")

# Columns of the names of rigs, and of a candidate's residuals [characters].
RIG_WIDTH, CANDIDATE_WIDTH = 28, 13
HEADINGS = {
    "candidate": "candidate",
    "residual_median_rad": "median",
    "residual_95_rad": "95 %",
    "residual_worst_rad": "worst",
    "within_count": "within",
    "worse_than_none": "worse",
    "worst_ratio": "ratio",
    "sensors_alone_rad": "sensors",
    "falls": "falls",
    "command_rms_v": "rms u",
    "command_step_v": "rms Δu",
    "command_high_frequency_v": "> 50 Hz",
    "delay_margin_s": "delay [s]",
    "pushes_survived": "pushes",
}
BY_RIG = "arm, peak to peak [rad], by rig; –: the pendulum falls"
BEST = {"best_bandwidth": "best bandwidth", "residual_at_best_rad": "with it"}


@click.command()
@option("--truths", is_flag=True, help="Compare on the built-in named rigs, and list each of them.")
@option(
    "--rigs",
    "number",
    type=click.IntRange(1, MOST_RIGS),
    default=100,
    help="Number of random rigs.",
)
@option(
    "--disturb",
    multiple=True,
    type=click.Choice((*DISTURBANCES, "all")),
    help="Add a disturbance to the random rigs; repeatable.",
)
@option(
    "--seed",
    type=SEED,
    default=0,
    help="Seed of the random rigs. The seed of the sensor noise is plant.seed.",
)
@rig_option
@parameter_options
@option(
    "--candidate",
    "texts",
    multiple=True,
    metavar="NAME[=PARAMETER=VALUE,...]",
    help=f"Candidate: a name with its settings, or one of {', '.join(STANDARD)}; repeatable "
    "(default: all of these).",
)
@option(
    "--push",
    "pushes",
    type=FiniteRange(-1e3, 1e3),
    multiple=True,
    metavar="V",
    help="Push the arm with this torque [V] for 0.1 s, in a separate run; repeatable.",
)
@option(
    "--bandwidths",
    is_flag=True,
    help="Find the recommended compensation's best bandwidth on each rig, as --truths does.",
)
@option(
    "--seconds",
    type=MEASURED_SECONDS,
    default=30.0,
    help="Simulated time of each run [s]; its second half is measured.",
)
@option(
    "--out",
    type=OutputFile(*TABLE_SUFFIXES, *FIGURE_SUFFIXES),
    help="Write a table with one row per run, or draw a picture.",
)
@json_option
@click.pass_context
def command(
    ctx: click.Context,
    truths: bool,
    number: int,
    disturb: tuple[str, ...],
    seed: int,
    rig: str,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    texts: tuple[str, ...],
    pushes: tuple[float, ...],
    bandwidths: bool,
    seconds: float,
    out: Path | None,
    as_json: bool,
) -> None:
    """Compare compensations on simulated rigs that they do not know.

    Example: furuta compare --rigs 1000 --candidate none --candidate lugre
    --candidate stiff=compensation=lugre,sigma0=1000

    A candidate keeps its settings on every rig. The rigs are random by default, named ones with
    --truths, and drawn from the uncertainty in its file with --rig.
    """
    from furuta.studies.comparison.comparison import Comparison
    from furuta.studies.comparison.scores import best_bandwidths, comparison_report, rank
    from furuta.studies.study_tables import check_table, write_runs
    from furuta_bringup.printing import print_table, with_progress

    if truths:
        _reject_random_options(ctx)
    table = out if out is not None and out.suffix in TABLE_SUFFIXES else None
    if table is not None:
        check_table(table)
    settings = load_settings((rig_file(rig), *files) if rig else files, assignments)
    about, uncertainty = load_uncertain_rig(rig_file(rig)) if rig else (NOMINAL, CERTAIN)
    random = RandomRigs(settings, number, seed, disturb, about, uncertainty)
    candidates = parse_candidates(texts or STANDARD, settings)
    chosen = named_rigs(settings) if truths else random
    comparison = Comparison(settings, chosen, candidates, seconds, pushes)
    rows = with_progress("comparing", comparison.rows(), comparison.size, quiet=as_json)
    if table is not None:
        write_runs(rows, table)
    deque(rows, maxlen=0)
    outcome, count = comparison.table(), loop(settings).plant.sensors.encoder_count
    scores = rank(outcome, count)
    if out is not None and table is None:
        from furuta.figures.comparison import draw_comparison

        draw_comparison(outcome, [score.candidate for score in scores], count, out)
    report = comparison_report(outcome, scores, count, by_rig=truths)
    if truths or bandwidths:
        scaled = Comparison(settings, chosen, bandwidth_candidates(), seconds)
        runs = with_progress("bandwidths", scaled.rows(), scaled.size, quiet=as_json)
        deque(runs, maxlen=0)
        report["best_bandwidths"] = best_bandwidths(scaled.table())
    report["impossible"] = len(comparison.impossible)
    chosen_settings = {each.name: each.settings for each in candidates}
    report["recommended_settings"] = chosen_settings.get(report["recommended"], {})
    if as_json:
        print_json(report)
        return
    if truths or bandwidths:
        _print_rigs(outcome, report["best_bandwidths"], with_candidates=truths)
    title = (
        f"arm, peak to peak [rad], over {report['rigs']} rigs; fraction within one count, which is "
        f"{count:.4f} rad; rigs that are worse by more than a count than without compensation, and "
        "the worst ratio; sensors alone; rms of u, of its steps and above 50 Hz [V]; delay and "
        "pushes survived"
    )
    print_table(title, report["ranking"], HEADINGS)
    last = ("impossible", "recommended_settings", "recommended")
    show({name: report[name] for name in last}, as_json)


def _print_rigs(table: Table, best: list[dict[str, Any]], with_candidates: bool) -> None:
    """Print what is known of each rig, some columns at a time: residuals, best bandwidth."""
    from furuta_bringup.printing import console, print_table

    candidates = table.candidates if with_candidates else []
    rows = [
        bandwidth | dict(zip(candidates, map(float, sizes), strict=False))
        for bandwidth, sizes in zip(best, table.residual.T, strict=True)
    ]
    headings = {name: name.replace("_", " ") for name in candidates} | BEST
    columns = max(1, (console().width - RIG_WIDTH) // CANDIDATE_WIDTH)
    for first in range(0, len(headings), columns):
        some = dict(list(headings.items())[first : first + columns])
        print_table(BY_RIG, rows, {"rig": "rig", **some})


def _reject_random_options(ctx: click.Context) -> None:
    """Reject options that would have no effect."""
    for parameter in ctx.command.params:
        given = ctx.get_parameter_source(str(parameter.name)) is ParameterSource.COMMANDLINE
        name = parameter.opts[0]
        if given and name in RANDOM_ONLY:
            raise ParameterError(f"{name} has no effect on the named rigs of --truths")
