"""``furuta linearize``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from furuta_bringup.option_types import FIGURE
from furuta_bringup.options import feedback_option, json_option, model_options, option
from furuta_bringup.printing import show
from furuta_model.parameters import ParameterError

if TYPE_CHECKING:
    from furuta.limit_cycles.pendulum_loop import IdealLoop
    from furuta_sim.simulation.closed_loop import Loop

# Name of the loop with the controller's or the given feedback, beside those of Fig. 4.
GIVEN = "given"


@click.command()
@option("--nyquist", is_flag=True, help="Nyquist plot from -F to the arm's speed, eq. (10).")
@option("--figure-4", is_flag=True, help="Nyquist plot of the four feedbacks of Fig. 4.")
@option("--passivity", is_flag=True, help="Condition under which the LuGre observer converges.")
@option("--out", type=FIGURE, help="Draw the Nyquist plot.")
@feedback_option
@model_options
@json_option
def command(
    nyquist: bool,
    figure_4: bool,
    passivity: bool,
    out: Path | None,
    feedback: tuple[float, float, float, float] | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Print the controller's linear model, eqs. (2) and (3), its poles, and its gain, eq. (7).

    The gain, phase, delay and disk margins apply if the friction is compensated exactly.
    sensors_alone_rad is the swing of the arm, peak to peak, that the sensors cause in a simulation
    without friction.

    --nyquist adds the crossings of the real axis, for the plant's model. Limit cycles are possible
    where G crosses the negative real axis, because -1/N of Coulomb friction covers this axis.
    --passivity depends on the plant's model and friction, on the feedback, and on the observer's
    gain K.
    """
    from furuta.margins import linear_report, nyquist_report
    from furuta.settings.settings import (
        law_and_feedback,
        load_settings,
        loop,
        require_agreement,
    )
    from furuta.studies.analysis_options import AnalysisOptions

    nyquist = nyquist or figure_4
    if figure_4 and feedback is not None:
        raise ParameterError("--figure-4 cannot be combined with --feedback")
    if out is not None and not nyquist:
        raise click.UsageError("--out needs --nyquist or --figure-4")
    require_agreement(assignments, law_and_feedback(None, feedback))
    settings = load_settings(files, assignments)
    nominal = loop(settings)
    report = linear_report(nominal, feedback)
    options = AnalysisOptions(settings, "lugre", feedback)
    if nyquist:
        from furuta.transfer import FIGURE_4

        ideal = options.ideal_loop()
        feedbacks = FIGURE_4 if figure_4 else {GIVEN: ideal.gains}
        cases = {case: ideal.with_gains(gains) for case, gains in feedbacks.items()}
        if out is not None:
            from furuta.figures.nyquist import draw_nyquist

            draw_nyquist(cases, out)
        report |= nyquist_report(cases)
    if passivity:
        report |= _passivity(options.ideal_loop(), nominal)
    show(report, as_json)


def _passivity(ideal: IdealLoop, nominal: Loop) -> dict[str, Any]:
    from furuta.passivity import observer_passivity

    gain = nominal.observer.observer_gain
    result = observer_passivity(ideal, gain)
    exact = (
        nominal.observer.friction == nominal.plant.friction.parameters
        and nominal.controller.model == nominal.plant.model
    )
    report = {**result._asdict(), "K": gain, "exact_model": exact}
    return {"passive": result.satisfied, "passivity": report}
