"""``furuta compare``."""

from __future__ import annotations

from pathlib import Path

import click

from furuta.studies.comparison.candidates import STANDARD
from furuta.studies.comparison.rigs import DISTURBANCES, MOST_RIGS
from furuta.tables import NAMED
from furuta_bringup.option_types import TABLE, FiniteRange
from furuta_bringup.options import (
    MEASURED_SECONDS,
    SEED,
    figure_option,
    json_option,
    option,
    parameter_options,
    rig_option,
)
from furuta_bringup.printing import bar, show

# Number of random rigs, unless the user says so.
RIGS = 100


@click.command()
@option(
    "--truths",
    is_flag=True,
    not_with=("--rigs", "--disturb", "--seed", "--bandwidths"),
    help="Compare on the built-in named rigs, and list each of them.",
)
@option(
    "--rigs",
    "number",
    type=click.IntRange(1, MOST_RIGS),
    help=f"Number of random rigs; default: {RIGS}.",
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
@option("--all", "every_column", is_flag=True, help="Print all columns of the ranking.")
@option("--out", type=TABLE, help="Write a table with one row per run.")
@figure_option("Draw the residuals of each candidate.")
@json_option
def command(
    truths: bool,
    number: int | None,
    disturb: tuple[str, ...],
    seed: int,
    rig: str,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    texts: tuple[str, ...],
    pushes: tuple[float, ...],
    bandwidths: bool,
    seconds: float,
    every_column: bool,
    out: Path | None,
    figure: Path | None,
    as_json: bool,
) -> None:
    """Compare compensations on simulated rigs that they do not know.

    Example: furuta compare --rigs 1000 --candidate none --candidate lugre
    --candidate stiff=compensation=lugre,sigma0=1000

    A candidate keeps its settings on every rig. The rigs are random by default, named ones with
    --truths, and drawn from the uncertainty in its file with --rig.
    """
    from furuta import compare, make_loop

    found = compare(
        make_loop(assignments, rig=rig or None, files=files),
        texts or None,
        NAMED if truths else number or RIGS,
        rig=None if truths else rig or None,
        seed=seed,
        disturbances=disturb,
        seconds=seconds,
        pushes=pushes,
        bandwidths=bandwidths or truths,
        out=out,
        progress=bar("comparing", as_json),
    )
    found.every_column = every_column
    show(found, as_json, figure)
