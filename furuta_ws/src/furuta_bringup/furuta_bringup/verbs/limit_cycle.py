"""``furuta limit-cycle``."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from furuta_bringup.option_types import FiniteRange
from furuta_bringup.options import (
    feedback_option,
    figure_option,
    json_option,
    law_option,
    model_options,
    option,
)
from furuta_bringup.printing import bar, show

if TYPE_CHECKING:
    from furuta.results.result import Result

# Values of a parameter of a map, if their number is not given.
DEFAULT_COUNT = 20
QUARTER_TURN = 0.5 * pi


@click.command()
@option(
    "--over",
    "ranges",
    multiple=True,
    metavar="NAME=LOW:HIGH[:COUNT]",
    help="Range of a parameter, or of a gain l1 to l4 of u = l·x. Given once: follow the branch "
    "of the limit cycle. Given twice: map the limit cycles.",
)
@option(
    "--predict",
    is_flag=True,
    not_with=("--over", "--linear", "--release"),
    help="Predict the limit cycle by the describing function instead.",
)
@law_option
@feedback_option
@option("--linear", is_flag=True, help="Use the linear pendulum instead of the nonlinear one.")
@option(
    "--release",
    type=FiniteRange(-QUARTER_TURN, QUARTER_TURN, min_open=True, max_open=True),
    default=0.05,
    help="Initial pendulum angle, not 0 [rad].",
)
@figure_option("Draw the cycle, branch or map, or G and -1/N.")
@model_options
@json_option
def command(
    ranges: tuple[str, ...],
    predict: bool,
    law: str | None,
    feedback: tuple[float, float, float, float] | None,
    linear: bool,
    release: float,
    figure: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute the exact periodic motion of the ideal loop, including sticking.

    In the ideal loop all states are measured, and the feedback u = l·x is neither sampled nor
    saturated. left_out names the settings that this ignores. Other parts of the plant, such as
    drive.lag, are rejected. A branch is followed through folds and along unstable cycles. The
    prediction, 1 + G(jω) N(A, ω) = 0, uses first harmonics only.

    Example: furuta limit-cycle --over omega1=2:12 --over omega2=2:12
    """
    from furuta import cycle_branch, cycle_map, limit_cycle, make_loop, predict_cycles
    from furuta.settings.settings import law_and_feedback, require_agreement
    from furuta.studies.ranges import parse_range

    if release == 0.0:
        raise click.UsageError("--release must not be 0")
    if len(ranges) > 2:
        raise click.UsageError("--over is given once or twice")
    require_agreement(assignments, law_and_feedback(law, feedback))
    loop = make_loop(assignments, files=files)
    ideal: dict[str, Any] = {"law": law, "feedback": feedback, "linear": linear}
    varied = [parse_range(text, DEFAULT_COUNT) for text in ranges]
    result: Result
    if predict:
        result = predict_cycles(loop, **ideal)
    elif not varied:
        result = limit_cycle(loop, theta=release, **ideal)
    elif len(varied) == 1:
        (name, values), *_ = varied
        result = cycle_branch(loop, name, values[0], values[-1], theta=release, **ideal)
    else:
        grid = dict(varied)
        result = cycle_map(loop, grid, theta=release, progress=bar("mapping", as_json), **ideal)
    show(result, as_json, figure)
