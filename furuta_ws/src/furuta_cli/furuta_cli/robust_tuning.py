"""Options and output of ``furuta tune --robust``."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import click
from rich.console import Console

from furuta_cli.number_types import FiniteRange
from furuta_cli.options import print_json
from furuta_friction.compensation import COMPENSATIONS
from furuta_graph.settings import load_settings, loop
from furuta_studies.robustness.robust_tuning import RobustResult, RobustTuning, tune_robustly
from furuta_studies.robustness.uncertain_rigs import UncertainRigs, relative_ranges
from furuta_studies.tuning.result import observer_parameters, write_parameter_file

Function = TypeVar("Function", bound=Callable[..., Any])

# Simulated time of a run [s].
SECONDS = 20.0


class RobustEffort(NamedTuple):
    """Rigs of a candidate, fresh rigs of the verdict, candidates, and the rigs' relative errors."""

    rigs: int
    fresh_rigs: int
    trials: int
    error: float
    model_error: float


def robust_options(function: Function) -> Callable[..., Any]:
    """The options of ``--robust``, passed on as the argument ``effort``."""

    @wraps(function)
    def command(
        rigs: int, fresh_rigs: int, trials: int, error: float, model_error: float, **others: Any
    ) -> Any:
        return function(effort=RobustEffort(rigs, fresh_rigs, trials, error, model_error), **others)

    wrapped: Any = command
    for name, kind, default, text in reversed(_OPTIONS):
        wrapped = click.option(
            name, type=kind, default=default, show_default=True, help=f"robust: {text}"
        )(wrapped)
    made: Callable[..., Any] = wrapped
    return made


_ERROR = FiniteRange(0, 1, max_open=True)
_OPTIONS: tuple[tuple[str, Any, float, str], ...] = (
    ("--rigs", click.IntRange(20, 10**6), 500, "number of rigs for each candidate."),
    ("--fresh-rigs", click.IntRange(20, 10**7), 2000, "number of fresh rigs for the verdict."),
    ("--trials", click.IntRange(10, 10_000), 40, "number of candidates."),
    ("--error", _ERROR, 0.3, "relative error of every friction parameter of the rigs."),
    ("--model-error", _ERROR, 0.1, "relative error of every coefficient of the pendulum."),
)


def tune_and_report(
    effort: RobustEffort,
    search: tuple[str, ...],
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    out: Path | None,
    as_json: bool,
) -> None:
    """Tune over uncertain rigs; print the result and write it to a parameter file."""
    nominal = loop(load_settings(files, assignments))
    if nominal.observer.compensation == "none":
        nominal = nominal._replace(observer=nominal.observer._replace(compensation="lugre"))
    rigs = UncertainRigs(nominal, relative_ranges(nominal.plant, effort.error, effort.model_error))
    rigs.check()
    seed = nominal.plant.seed
    rivals = tuple(each for each in COMPENSATIONS if each != "none")
    tuning = RobustTuning(rigs, search, effort.rigs, effort.trials, SECONDS, seed, rivals)
    console = Console(stderr=True, quiet=as_json)
    result = tune_robustly(
        tuning,
        effort.fresh_rigs,
        lambda number, found: console.print(f"candidate {number}: {found:.4f} rad"),
    )
    if out is not None:
        write_parameter_file(result.observer, out)
    if as_json:
        print_json(_as_json(result, effort))
    else:
        _print(result, effort, out)


def _as_json(result: RobustResult, effort: RobustEffort) -> dict[str, Any]:
    return {
        "parameters": observer_parameters(result.observer),
        "before": {"p95_rad": result.fresh_before},
        "after": {"p95_rad": result.fresh_after},
        "tuned_on": {"p95_before_rad": result.before, "p95_after_rad": result.after},
        "trials": result.trials,
        **effort._asdict(),
    }


def _print(result: RobustResult, effort: RobustEffort, out: Path | None) -> None:
    print(f"95 % quantile of the arm, peak to peak, on {effort.fresh_rigs} fresh rigs")
    print(f"before                   {result.fresh_before:.4f} rad")
    print(f"after                    {result.fresh_after:.4f} rad")
    for name, value in observer_parameters(result.observer).items():
        print(f"{name:24} {value if isinstance(value, str) else f'{value:.5g}'}")
    if out is not None:
        print(f"parameter file: {out}")
