"""``furuta experiment``."""

from pathlib import Path

import click
from rich.console import Console
from rich.markup import escape

from furuta.studies.experiments import (
    EXPERIMENTS,
    encoder_resolution,
    run_experiment,
)
from furuta_bringup.options import MEASURED_SECONDS, json_option, model_options
from furuta_bringup.printing import print_json
from furuta_bringup.terminal import print_table
from furuta_sim.settings.settings import load_settings, loop

HEADINGS = {
    "experiment": "experiment",
    "compensation": "compensation",
    "phi_peak_to_peak_rad": "measured [rad]",
    "predicted_phi_peak_to_peak_rad": "predicted [rad]",
    "describing_function_phi_peak_to_peak_rad": "describing f. [rad]",
    "period_s": "period [s]",
}


@click.command()
@click.argument("names", nargs=-1, type=click.Choice([*EXPERIMENTS, "all"]), required=True)
@click.option(
    "--seconds",
    type=MEASURED_SECONDS,
    default=30.0,
    show_default=True,
    help="Simulated time after the transients [s].",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Draw each figure.",
)
@model_options
@json_option
def command(
    names: tuple[str, ...],
    seconds: float,
    out: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Repeat experiments of the paper (fig5 to fig9, or all), and compare with the prediction.

    The simulation uses the same functions as the nodes. From fig6 on the true friction differs by
    direction, by 5 % unless it is set with --set.
    """
    nominal = loop(load_settings(files, assignments))
    rows = []
    console = Console(stderr=True, quiet=as_json)
    for name in EXPERIMENTS if "all" in names else dict.fromkeys(names):
        with console.status(name) as status:
            result = run_experiment(
                name, nominal, seconds, lambda message, _: status.update(escape(message))
            )
        if out is not None:
            from furuta.figures.run import draw_experiment

            draw_experiment(EXPERIMENTS[name].title, result, out / f"{name}.png")
        rows.append({"experiment": name, **result.report()})
    count = encoder_resolution(nominal)
    if as_json:
        print_json({"experiments": rows, "encoder_count_rad": count})
    else:
        print_table(f"arm, peak to peak; one encoder count is {count:.4f} rad", rows, HEADINGS)
