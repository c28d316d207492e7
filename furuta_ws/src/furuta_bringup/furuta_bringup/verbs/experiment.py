"""``furuta experiment``."""

from math import isnan
from pathlib import Path
from typing import Any

import click
from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from furuta.studies.experiments import (
    EXPERIMENTS,
    encoder_resolution,
    run_experiment,
)
from furuta.studies.swing_up_starts import judge, swing_up_settings
from furuta_bringup.options import MEASURED_SECONDS, json_option, model_options
from furuta_bringup.printing import print_json, show
from furuta_sim.settings.rigs import find_rig
from furuta_sim.settings.settings import load_settings, loop
from furuta_sim.simulation.closed_loop import simulate

# The experiment beside those of the paper, its rig, and its simulated time [s].
SWING_UP = "swing-up"
FULL_TURN_RIG = "paper_full_turn"
SWING_UP_TIME = 8.0
# Part of it that the animation shows [s].
SHOWN_TIME = 6.0


@click.command()
@click.argument(
    "names", nargs=-1, type=click.Choice([*EXPERIMENTS, SWING_UP, "all"]), required=True
)
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
    help="Draw each figure; of swing-up also an animation.",
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

    swing-up is not of the paper: from hanging to upright, with a full-turn encoder.

    The simulation uses the same functions as the nodes. From fig6 on the true friction differs by
    direction, by 5 % unless it is set with --set.
    """
    if SWING_UP in names:
        if len(names) > 1:
            raise click.UsageError("swing-up is an experiment of its own: name no other with it")
        _swing_up(out, files, assignments, as_json)
        return
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
    if as_json:
        print_json({"experiments": rows, "encoder_count_rad": encoder_resolution(nominal)})
    else:
        _print(rows, encoder_resolution(nominal))


def _swing_up(
    out: Path | None, files: tuple[Path, ...], assignments: tuple[str, ...], as_json: bool
) -> None:
    """Swing the paper's rig with a full-turn encoder up, and draw it."""
    settings = load_settings(files, assignments, swing_up_settings(find_rig(FULL_TURN_RIG)))
    nominal = loop(settings)
    record = simulate(nominal, SWING_UP_TIME)
    if out is not None:
        from furuta.figures.animation import animate_run
        from furuta.figures.run import draw_run

        draw_run(record, out / f"{SWING_UP}.png")
        animate_run(record, out / f"{SWING_UP}.gif", SHOWN_TIME)
    show({"experiment": SWING_UP, **judge(record, nominal)._asdict()}, as_json)


def _print(rows: list[dict[str, Any]], count: float) -> None:
    table = Table(title=f"arm, peak to peak; one encoder count is {count:.4f} rad", box=SIMPLE)
    table.add_column("experiment", no_wrap=True)
    table.add_column("compensation", no_wrap=True)
    for heading in ("measured [rad]", "predicted [rad]", "describing f. [rad]", "period [s]"):
        table.add_column(escape(heading), justify="right")
    for row in rows:
        table.add_row(
            row["experiment"],
            row["compensation"] + ", tuned" * EXPERIMENTS[row["experiment"]].tuned,
            *(
                "–" if isnan(row[key]) else f"{row[key]:.4f}"
                for key in (
                    "phi_peak_to_peak_rad",
                    "predicted_phi_peak_to_peak_rad",
                    "describing_function_phi_peak_to_peak_rad",
                    "period_s",
                )
            ),
        )
    Console().print(table)
