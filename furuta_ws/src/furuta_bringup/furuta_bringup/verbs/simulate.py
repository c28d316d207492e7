"""``furuta simulate``."""

from pathlib import Path
from time import perf_counter

import click

from furuta_bringup.option_types import SERIES
from furuta_bringup.options import (
    SEED,
    SIMULATED_SECONDS,
    feedback_option,
    figure_option,
    json_option,
    law_option,
    model_options,
    option,
)
from furuta_bringup.printing import bar, show, with_status


@click.command()
@option("--seconds", type=SIMULATED_SECONDS, default=60.0, help="Simulated time [s].")
@option(
    "--compensation",
    metavar="NAME",
    help="Friction compensation; default: as set by the parameters.",
)
@option(
    "--ideal-sensors",
    is_flag=True,
    help="Measure all four states exactly; the arm may turn without limit.",
)
@law_option
@feedback_option
@option("--seed", type=SEED, help="Seed of the sensors' noise.")
@option("--out", type=SERIES, metavar="FILE", help="Write the series (.npz, .csv, .mat, .parquet).")
@figure_option("Draw the series over time.")
@model_options
@json_option
def command(
    seconds: float,
    compensation: str | None,
    ideal_sensors: bool,
    law: str | None,
    feedback: tuple[float, float, float, float] | None,
    seed: int | None,
    out: Path | None,
    figure: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Simulate the closed loop without ROS and measure the motion in its second half."""
    from furuta import make_loop, simulate
    from furuta.settings.settings import law_and_feedback, require_agreement
    from furuta_model.state import LARGEST_VALUE

    first, options = [], law_and_feedback(law, feedback)
    if compensation is not None:
        options["--compensation"] = f"friction_observer.compensation={compensation}"
    if ideal_sensors:
        options["--ideal-sensors"] = "sensors.ideal=true"
        # The arm may turn for ever, and its feedback is linear.
        limits = ("angle", "error", "speed")
        first = [f"controller.arm_{limit}_limit={LARGEST_VALUE}" for limit in limits]
    if seed is not None:
        options["--seed"] = f"plant.seed={seed}"
    require_agreement(assignments, options)
    with with_status("loading", as_json):
        loop = make_loop([*first, *assignments, *options.values()], files=files)
    began = perf_counter()
    run = simulate(loop, seconds, progress=bar("simulating", as_json))
    wall_seconds = perf_counter() - began
    try:
        if out is not None:
            run.write(out)
    finally:  # also if that fails
        show(run, as_json, figure, wall_seconds=wall_seconds)
