"""``furuta rig``."""

from __future__ import annotations

from typing import Any

import click

from furuta_cli.number_types import FiniteRange
from furuta_cli.options import SEED, json_option, print_json
from furuta_graph.rigs import find_uncertain_rig
from furuta_studies.rig_check import RigCheck, check_rig


@click.group()
def command() -> None:
    """Check a rig file, and propose the next experiment."""


@command.command()
@click.argument("name", metavar="NAME|FILE")
@click.option(
    "--rigs", type=click.IntRange(1, 100_000), default=100, show_default=True, help="Random rigs."
)
@click.option(
    "--seconds",
    type=FiniteRange(5, 3600),
    default=20.0,
    show_default=True,
    help="Simulated time of each [s].",
)
@click.option("--seed", type=SEED, default=0, show_default=True, help="Seed of the random rigs.")
@json_option
def check(name: str, rigs: int, seconds: float, seed: int, as_json: bool) -> None:
    """Simulate rigs as uncertain as the file says, with every compensation.

    Estimator and controller have the values of the file. The exit status is 1 if no compensation
    holds all pendulums upright.
    """
    rig, uncertainty = find_uncertain_rig(name)
    result = check_rig(rig, uncertainty, rigs, seconds, seed)
    if as_json:
        print_json(_as_json(result))
    else:
        _print(result, certain=not uncertainty.names)
    if result.recommended is None:
        raise click.exceptions.Exit(1)


def _as_json(result: RigCheck) -> dict[str, Any]:
    return {**result._asdict(), "rows": [row._asdict() for row in result.rows]}


def _print(result: RigCheck, certain: bool) -> None:
    if certain:
        print("the file states no uncertainty: all rigs are alike, except for noise")
    print(f"{'compensation':22}{'falls':>7}{'median':>11}{'95 %':>11}{'worst':>11}   [rad]")
    for row in result.rows:
        sizes = "".join(f"{each:11.4f}" for each in (row.median_rad, row.p95_rad, row.worst_rad))
        print(f"{row.compensation:22}{row.falls:7d}{sizes}")
    if result.recommended is None:
        print("no compensation holds all pendulums upright")
    else:
        print(
            f"recommended: {result.recommended}; fewer than {result.falls_below:.1%} fall "
            "(95 % confidence)"
        )
    for name, correlation in result.influences.items():
        print(f"the residual depends on {name} (rank correlation {correlation:+.2f})")
