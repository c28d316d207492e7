"""Options and output of ``furuta tune --robust``."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from math import isinf
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import click
from rich.console import Console

from furuta.studies.robustness.robust_tuning import RobustResult, RobustTuning, tune_robustly
from furuta.studies.robustness.uncertain_rigs import UncertainRigs
from furuta.studies.tuning.result import observer_parameters, write_parameter_file
from furuta_bringup.options import print_json
from furuta_bringup.uncertain_rig_options import RigOptions
from furuta_friction.compensation import COMPENSATIONS

Function = TypeVar("Function", bound=Callable[..., Any])

# Simulated time of a run [s].
SECONDS = 20.0


class RobustEffort(NamedTuple):
    """Rigs of a candidate, fresh rigs of the verdict, and candidates."""

    rigs: int
    fresh_rigs: int
    trials: int


def robust_options(function: Function) -> Callable[..., Any]:
    """The options of ``--robust``, passed on as the argument ``effort``."""

    @wraps(function)
    def command(rigs: int, fresh_rigs: int, trials: int, **others: Any) -> Any:
        return function(effort=RobustEffort(rigs, fresh_rigs, trials), **others)

    wrapped: Any = command
    for name, kind, default, text in reversed(_OPTIONS):
        wrapped = click.option(
            name, type=kind, default=default, show_default=True, help=f"robust: {text}"
        )(wrapped)
    made: Callable[..., Any] = wrapped
    return made


_OPTIONS: tuple[tuple[str, Any, int, str], ...] = (
    ("--rigs", click.IntRange(20, 10**6), 500, "number of rigs for each candidate."),
    ("--fresh-rigs", click.IntRange(20, 10**7), 2000, "number of fresh rigs for the verdict."),
    ("--trials", click.IntRange(10, 10_000), 40, "number of candidates."),
)


def tune_and_report(
    effort: RobustEffort,
    rig_options: RigOptions,
    search: tuple[str, ...],
    out: Path | None,
    as_json: bool,
) -> None:
    """Tune over uncertain rigs; print the result and write it to a parameter file."""
    rigs = rig_options.uncertain_rigs()
    nominal = rigs.nominal
    if nominal.observer.compensation == "none":
        nominal = nominal._replace(observer=nominal.observer._replace(compensation="lugre"))
        rigs = rigs._replace(nominal=nominal)
    seed = nominal.plant.seed
    rivals = tuple(each for each in COMPENSATIONS if each != "none")
    tuning = RobustTuning(rigs, search, effort.rigs, effort.trials, SECONDS, seed, rivals)
    console = Console(stderr=True, quiet=as_json)
    result = tune_robustly(
        tuning,
        effort.fresh_rigs,
        lambda number, found: console.print(f"candidate {number}: {_words(found)}"),
    )
    if out is not None:
        write_parameter_file(result.observer, out)
    if as_json:
        print_json(_as_json(result, effort, rigs))
    else:
        _print(result, effort, out)


def _as_json(result: RobustResult, effort: RobustEffort, rigs: UncertainRigs) -> dict[str, Any]:
    return {
        "parameters": observer_parameters(result.observer),
        "before": {"p95_rad": result.fresh_before},
        "after": {"p95_rad": result.fresh_after},
        "tuned_on": {"p95_before_rad": result.before, "p95_after_rad": result.after},
        "trials": result.trials,
        **effort._asdict(),
        "uncertain": {name: list(limits) for name, limits in rigs.ranges.items()},
        "standard_errors": rigs.uncertainty.standard_errors,
    }


def _print(result: RobustResult, effort: RobustEffort, out: Path | None) -> None:
    print(f"95 % quantile of the arm, peak to peak, on {effort.fresh_rigs} fresh rigs")
    print(f"before                   {_words(result.fresh_before)}")
    print(f"after                    {_words(result.fresh_after)}")
    for name, value in observer_parameters(result.observer).items():
        print(f"{name:24} {value if isinstance(value, str) else f'{value:.5g}'}")
    if out is not None:
        print(f"parameter file: {out}")


def _words(quantile: float) -> str:
    return "more than 5 % of the rigs fall" if isinf(quantile) else f"{quantile:.4f} rad"
