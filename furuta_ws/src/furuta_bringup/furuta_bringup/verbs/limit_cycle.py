"""``furuta limit-cycle``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
import numpy as np

from furuta.limit_cycles.continuation import Branch, BranchPoint, fold_value
from furuta.limit_cycles.limit_cycle import limit_cycle, state_at_rest
from furuta.limit_cycles.periodic_orbit import LimitCycle, trace
from furuta.studies.analysis_options import AnalysisOptions, require_stabilising
from furuta.studies.parameter_range import parse_range
from furuta_bringup.file_types import FIGURE
from furuta_bringup.number_types import FiniteRange
from furuta_bringup.options import ideal_options, json_option, model_options, print_json
from furuta_bringup.printing import rounded
from furuta_model.parameters import ParameterError

# Values of the parameter at which a cycle is looked for, if the current one is outside the range.
BRANCH_STARTS = 9


@click.command()
@ideal_options
@click.option("--linear", is_flag=True, help="Linear pendulum instead of the nonlinear one.")
@click.option(
    "--release",
    type=FiniteRange(-0.5 * np.pi, 0.5 * np.pi, min_open=True, max_open=True),
    default=0.05,
    show_default=True,
    help="Initial pendulum angle, not 0 [rad].",
)
@click.option("--branch", metavar="NAME=LOW:HIGH", help="Follow the limit cycle over a parameter.")
@click.option("--out", type=FIGURE, help="Draw the limit cycle, or the branch.")
@model_options
@json_option
def command(
    law: str | None,
    feedback: tuple[float, float, float, float] | None,
    linear: bool,
    release: float,
    branch: str | None,
    out: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute the exact periodic motion of the ideal loop, including sticking.

    In the ideal loop all states are measured, and the feedback u = l·x is neither sampled nor
    saturated. --branch follows the limit cycle over a parameter, through folds and along unstable
    cycles.
    """
    choice = AnalysisOptions(files, assignments, law, feedback, linear)
    loop = choice.ideal_loop()
    if release == 0.0:
        raise click.UsageError("--release must not be 0")
    cycle = limit_cycle(loop, state_at_rest(release))
    if cycle.kind == "unbounded":
        require_stabilising(loop)
    result = _described(cycle)
    if branch is not None:
        name, ends = parse_range(branch, 2)
        points = _follow(choice, name, cycle, float(ends[0]), float(ends[-1]))
        result["branch"] = [_row(name, point) for point in points]
        result["events"] = [
            {"event": p.event, name: fold_value(points, i) if p.event == "fold" else p.value}
            for i, p in enumerate(points)
            if p.event
        ]
        if out is not None:
            from furuta.figures.limit_cycle import draw_branch

            draw_branch(name, points, out)
    elif out is not None:
        if cycle.kind != "oscillation":
            raise ParameterError(f"there is no limit cycle to draw in {out}: {cycle.kind}")
        from furuta.figures.limit_cycle import draw_limit_cycle

        draw_limit_cycle(trace(loop, cycle), cycle, loop.law.name, out)
    if as_json:
        print_json(result)
    else:
        _print(result)


def _follow(
    choice: AnalysisOptions, name: str, cycle: LimitCycle, low: float, high: float
) -> list[BranchPoint]:
    """The branch through the cycle at the current value, or at the first value that has one."""
    branch = Branch(lambda value: choice.ideal_loop({name: value}), low, high)
    here = choice.value(name)
    if here is not None and low <= here <= high:
        return branch.follow(here, cycle)
    found = []
    for value in _from_the_middle(np.linspace(low, high, BRANCH_STARTS)):
        cycle = limit_cycle(choice.ideal_loop({name: value}))
        if cycle.kind == "oscillation" and np.isfinite(cycle.period_s):
            return branch.follow(value, cycle)
        found.append(f"{cycle.kind} at {value:g}")
    raise ParameterError(f"no limit cycle with a finite period to follow: {', '.join(found)}")


def _from_the_middle(values: np.ndarray) -> list[float]:
    middle = values[len(values) // 2]
    return sorted((float(each) for each in values), key=lambda each: abs(each - middle))


def _described(cycle: LimitCycle) -> dict[str, Any]:
    fields = cycle._asdict()
    del fields["point"], fields["smallest_slide"]
    fields["floquet_multipliers"] = [[m.real, m.imag] for m in cycle.floquet_multipliers]
    return {**fields, "stable": cycle.stable}


def _row(name: str, point: BranchPoint) -> dict[str, Any]:
    return {
        name: point.value,
        "phi_peak_to_peak_rad": point.cycle.phi_peak_to_peak_rad,
        "period_s": point.cycle.period_s,
        "stable": point.cycle.stable,
    }


def _print(result: dict[str, Any]) -> None:
    for name, value in result.items():
        if name == "floquet_multipliers":
            print(f"{name:24} " + ", ".join(f"{re:.4g}{im:+.4g}j" for re, im in value))
        elif name == "branch":
            print(f"{name:24} {len(value)} cycles")
        elif name == "events":
            for event in value:
                print(f"{'':24} " + ", ".join(f"{k} {rounded(each)}" for k, each in event.items()))
        else:
            print(f"{name:24} {rounded(value)}")
