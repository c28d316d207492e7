"""``furuta limit-cycle``."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from furuta_bringup.option_types import FIGURE, FiniteRange
from furuta_bringup.options import feedback_option, json_option, law_option, model_options, option
from furuta_bringup.printing import show
from furuta_model.parameters import ParameterError

if TYPE_CHECKING:
    from furuta.studies.analysis_options import AnalysisOptions

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
    "--predict", is_flag=True, help="Predict the limit cycle by the describing function instead."
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
@option("--out", type=FIGURE, help="Draw the cycle, branch or map, or G and -1/N.")
@model_options
@json_option
def command(
    ranges: tuple[str, ...],
    predict: bool,
    law: str | None,
    feedback: tuple[float, float, float, float] | None,
    linear: bool,
    release: float,
    out: Path | None,
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
    from furuta.settings.settings import law_and_feedback, load_settings, require_agreement
    from furuta.studies.analysis_options import AnalysisOptions

    if release == 0.0:
        raise click.UsageError("--release must not be 0")
    if len(ranges) > 2 or (ranges and predict):
        raise click.UsageError("--over is given once or twice, and not with --predict")
    require_agreement(assignments, law_and_feedback(law, feedback))
    options = AnalysisOptions(load_settings(files, assignments), law, feedback, linear)
    if predict:
        report = _prediction(options, out)
    elif len(ranges) == 2:
        report = _map(options, ranges, release, out, quiet=as_json)
    else:
        report = _cycle(options, ranges, release, out)
    show(report | {"left_out": options.left_out()}, as_json)


def _prediction(options: AnalysisOptions, out: Path | None) -> dict[str, Any]:
    from furuta.describing_functions.predicted_cycles import predict_cycles
    from furuta.motions import prediction_report
    from furuta.transfer import transfer

    ideal = options.ideal_loop()
    prediction = predict_cycles(transfer(ideal.body, ideal.gains), ideal.law)
    if out is not None:
        from furuta.figures.nyquist import draw_describing_function

        draw_describing_function(ideal, prediction, out)
    return prediction_report(ideal, prediction)


def _cycle(
    options: AnalysisOptions, ranges: tuple[str, ...], release: float, out: Path | None
) -> dict[str, Any]:
    """The limit cycle, and the branch that leads through it."""
    from furuta.limit_cycles.limit_cycle import limit_cycle, state_at_rest
    from furuta.loops import require_stabilising

    ideal = options.ideal_loop()
    cycle = limit_cycle(ideal, state_at_rest(release))
    if cycle.kind == "unbounded":
        require_stabilising(ideal)
    if ranges:
        from furuta.limit_cycles.continuation import branch_report, follow_branch
        from furuta.studies.analysis_options import parse_varied

        name, ends = parse_varied(ranges[0], 2)
        points = follow_branch(
            lambda value: options.ideal_loop({name: value}),
            float(ends[0]),
            float(ends[-1]),
            options.value(name),
            cycle,
        )
        if out is not None:
            from furuta.figures.limit_cycle import draw_branch

            draw_branch(name, points, out)
        return cycle.report() | branch_report(name, points)
    if out is not None:
        if cycle.kind != "oscillation":
            raise ParameterError(f"there is no limit cycle to draw in {out}: {cycle.kind}")
        from furuta.figures.limit_cycle import draw_limit_cycle
        from furuta.limit_cycles.periodic_orbit import trace

        draw_limit_cycle(trace(ideal, cycle), cycle, ideal.law.name, out)
    return cycle.report()


def _map(
    options: AnalysisOptions,
    ranges: tuple[str, ...],
    release: float,
    out: Path | None,
    quiet: bool,
) -> dict[str, Any]:
    from furuta.studies.analysis_options import parse_varied
    from furuta.studies.feedback_map import map_feedbacks
    from furuta_bringup.printing import with_progress

    (first, firsts), (second, seconds) = (parse_varied(text, DEFAULT_COUNT) for text in ranges)
    if first == second:
        raise ParameterError(f"a map needs two different parameters, given {first} twice")
    mapped = map_feedbacks(
        lambda a, b: options.ideal_loop({first: a, second: b}), firsts, seconds, release
    )
    points = list(with_progress("mapping", mapped, len(firsts) * len(seconds), quiet))
    if out is not None:
        from furuta.figures.feedback_map import draw_map

        draw_map(first, second, firsts, seconds, points, out)
    return {"rows": [point.row(first, second) for point in points]}
