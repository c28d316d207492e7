"""``furuta rig``."""

from __future__ import annotations

import math
from typing import Any

import click

from furuta.studies.comparison.candidates import STANDARD
from furuta.studies.next_experiment import Proposal, propose
from furuta.studies.rig_check import RigCheck, check_rig
from furuta_bringup.number_types import FiniteRange
from furuta_bringup.options import SEED, json_option, print_json
from furuta_model.parameters import ParameterError
from furuta_sim.settings.rigs import find_uncertain_rig


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


@command.command()
@click.argument("name", metavar="NAME|FILE")
@click.option(
    "--seconds",
    type=FiniteRange(1, 3600),
    default=20.0,
    show_default=True,
    help="Length of the experiment [s].",
)
@json_option
def experiment(name: str, seconds: float, as_json: bool) -> None:
    """Propose the signal that tells most about what the file leaves uncertain.

    The pendulum hangs and is driven in open loop, within the rig's limits of arm angle, arm speed
    and voltage. Standard errors after it are those of a model with an error of 1 %.
    """
    rig, uncertainty = find_uncertain_rig(name)
    if not uncertainty.names:
        raise ParameterError(f"{name} states no uncertainty; furuta identify --write does")
    proposal = propose(rig, uncertainty, seconds)
    if proposal is None:
        raise ParameterError(f"no signal of {seconds:g} s stays within the limits of {name}")
    if as_json:
        print_json(proposal._asdict())
    else:
        _print_proposal(proposal)


def _print_proposal(p: Proposal) -> None:
    for name, before in p.before.items():
        print(f"{name:20}{before:12.3g} -> {p.after[name]:.3g}")
    print(f"the arm moves by {p.arm_travel_rad:.1f} rad, with up to {p.arm_speed_rad_s:.1f} rad/s")
    print(
        f"run with the pendulum hanging: --seconds {p.seconds:g} --set controller.mode=open_loop "
        f"--set controller.excitation.kind={p.kind} "
        f"--set controller.excitation.amplitude={p.amplitude_v:g} "
        f"--set controller.excitation.period={p.period_s:g} "
        f"--set controller.excitation.excursion_limit={math.ceil(1.2 * p.arm_travel_rad)} "
        f"--set controller.excitation.speed_limit={math.ceil(1.2 * p.arm_speed_rad_s)}"
    )


def _options(candidate: str) -> str:
    """The options of other verbs that choose a standard candidate."""
    settings = STANDARD[candidate].settings.items()
    return " ".join(f"--set {name.rpartition('.')[2]}={value}" for name, value in settings)


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
            f"(95 % confidence); choose it by {_options(result.recommended)}"
        )
    for name, correlation in result.influences.items():
        print(f"the residual depends on {name} (rank correlation {correlation:+.2f})")
