"""``furuta linearize``."""

from __future__ import annotations

from pathlib import Path

import click

from furuta_bringup.options import (
    feedback_option,
    figure_option,
    json_option,
    model_options,
    option,
)
from furuta_bringup.printing import show


@click.command()
@option("--nyquist", is_flag=True, help="Nyquist plot from -F to the arm's speed, eq. (10).")
@option(
    "--figure-4",
    is_flag=True,
    not_with=("--nyquist", "--feedback"),
    help="Nyquist plot of the four feedbacks of Fig. 4.",
)
@option("--passivity", is_flag=True, help="Condition under which the LuGre observer converges.")
@figure_option("Draw the Nyquist plot.")
@feedback_option
@model_options
@json_option
def command(
    nyquist: bool,
    figure_4: bool,
    passivity: bool,
    figure: Path | None,
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
    from furuta import linear_model, make_loop
    from furuta.settings.settings import law_and_feedback, require_agreement

    require_agreement(assignments, law_and_feedback(None, feedback))
    model = linear_model(
        make_loop(assignments, files=files),
        feedback=feedback,
        nyquist=nyquist or figure is not None,
        figure_4=figure_4,
        passivity=passivity,
    )
    show(model, as_json, figure)
