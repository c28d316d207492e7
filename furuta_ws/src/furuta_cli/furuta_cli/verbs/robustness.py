"""``furuta robustness``."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path
from time import perf_counter
from typing import Any

import click
import numpy as np
from rich.console import Console
from rich.progress import Progress

from furuta_analysis.simulation.closed_loop import Loop
from furuta_cli.file_types import FIGURE
from furuta_cli.number_types import FiniteRange
from furuta_cli.options import MEASURED_SECONDS, SEED, json_option, model_options, print_json
from furuta_graph.settings import load_settings, loop
from furuta_model.parameters import ParameterError
from furuta_studies.experiments import encoder_resolution
from furuta_studies.robustness.robustness import (
    Robustness,
    Sensitivity,
    residuals,
    robustness,
    sobol,
)
from furuta_studies.robustness.uncertain_rigs import FRICTION, MODEL, UncertainRigs, relative_ranges

ERROR = FiniteRange(0, 1, max_open=True)
MAX_RIGS = 10_000_000


def uncertain_rigs(
    nominal: Loop, ranges: tuple[str, ...], error: float, model_error: float
) -> UncertainRigs:
    """The rigs that the options describe."""
    given = relative_ranges(nominal.plant, error, model_error)
    given |= dict(parse_uncertain(each) for each in ranges)
    rigs = UncertainRigs(nominal, given)
    if not given:
        raise ParameterError("no parameter is uncertain: give --error, --model-error or NAME=L:H")
    rigs.check()
    return rigs


def parse_uncertain(text: str) -> tuple[str, tuple[float, float]]:
    """Name and range of NAME=LOW:HIGH."""
    name, _, rest = text.partition("=")
    names = (*FRICTION, *MODEL)
    if name not in names:
        raise ParameterError(f"uncertain can be {', '.join(names)}; given {text!r}")
    try:
        low, high = map(float, rest.split(":"))
    except ValueError:
        raise ParameterError(f"expected NAME=LOW:HIGH, given {text!r}") from None
    if not (np.isfinite([low, high]).all() and low < high):
        raise ParameterError(f"{name}: needs finite LOW < HIGH, given {rest!r}")
    return name, (low, high)


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
@click.option("--error", type=ERROR, default=0.3, show_default=True,
    help="Relative error of every friction parameter.")  # fmt: skip
@click.option("--model-error", type=ERROR, default=0.1, show_default=True,
    help="Relative error of every coefficient of the pendulum.")  # fmt: skip
@click.option("--seconds", type=MEASURED_SECONDS, default=20.0, show_default=True,
    help="Simulated time of each run [s].")  # fmt: skip
@click.option("--seed", type=SEED, default=0, show_default=True, help="Seed of the rigs.")
@click.option("--sobol", "points", type=click.IntRange(2, 2**20), metavar="N",
    help="Compute Sobol indices with N points, a power of two.")  # fmt: skip
@click.option("--out", type=FIGURE, metavar="FILE.png",
    help="Draw the residual over the two parameters that matter most.")  # fmt: skip
@model_options
@json_option
def command(
    ranges: tuple[str, ...],
    rigs: int,
    bound: float | None,
    error: float,
    model_error: float,
    seconds: float,
    seed: int,
    points: int | None,
    out: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Measure how sure a compensation is over rigs that are known only roughly.

    Each parameter of the simulated rig is anywhere in its range; estimator, friction observer and
    controller keep their values. Prints the probability that the arm's residual peak-to-peak angle
    stays within the bound, with its 95 % confidence interval.

    Example: furuta robustness alpha0=0.15:0.3 --rigs 10000 --set compensation=lugre
    """
    if points is not None and points & (points - 1):
        raise ParameterError(f"--sobol must be a power of two, given {points}")
    began = perf_counter()
    nominal = loop(load_settings(files, assignments))
    study = uncertain_rigs(nominal, ranges, error, model_error)
    bound = bound or encoder_resolution(study.nominal) or 2.0 * np.pi / 250
    total = rigs + (points * (len(study.ranges) + 2) if points else 0)
    console = Console(stderr=True, quiet=as_json or not sys.stderr.isatty())
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("simulating", total=total)

        def counted(each: Iterable[float]) -> Iterator[float]:
            for one in each:
                progress.advance(task)
                yield one

        found = np.fromiter(counted(residuals(study.loops(rigs, seed), seconds)), float, rigs)
        indices = (
            sobol(study, points, seed, seconds, lambda: progress.advance(task)) if points else []
        )
    result = robustness(found, bound)
    if out is not None:
        _draw(study, found, indices, seed, bound, out)
    summary = _summary(result, bound, study, indices, perf_counter() - began)
    if as_json:
        print_json(summary)
    else:
        _print(summary)


def _summary(
    found: Robustness,
    bound: float,
    study: UncertainRigs,
    indices: list[Sensitivity],
    seconds: float,
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
        "uncertain": {name: list(limits) for name, limits in study.ranges.items()},
        "sobol": [each._asdict() for each in indices],
        "wall_seconds": seconds,
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
        else:
            print(f"{name:24} {value:.5g}")


def _draw(
    study: UncertainRigs,
    found: np.ndarray,
    indices: list[Sensitivity],
    seed: int,
    bound: float,
    out: Path,
) -> None:
    from furuta_figures.robustness import draw_robustness

    cube = np.array(list(islice(study.points(seed), len(found))))
    names = list(study.ranges)
    weights = [each.total for each in indices] or _rank_correlations(cube, found)
    chosen = sorted(np.argsort(weights)[::-1][:2])
    if len(chosen) < 2:
        raise ParameterError("--out draws two parameters: more than one must be uncertain")
    first, second = (int(each) for each in chosen)
    limits = np.array([study.ranges[names[each]] for each in (first, second)])
    shown = limits[:, 0] + cube[:, [first, second]] * (limits[:, 1] - limits[:, 0])
    draw_robustness((names[first], names[second]), shown, found, bound, out)


def _rank_correlations(cube: np.ndarray, found: np.ndarray) -> list[float]:
    """Size of the correlation of each parameter with the rank of the residual."""
    ranks = np.argsort(np.argsort(found))
    return [abs(float(np.corrcoef(column, ranks)[0, 1])) for column in cube.T]
