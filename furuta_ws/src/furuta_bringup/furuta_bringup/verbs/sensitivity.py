"""``furuta sensitivity``."""

from __future__ import annotations

from pathlib import Path

import click
from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from furuta.studies.experiments import encoder_resolution
from furuta.studies.sensitivity import SensitivityRow, run_sensitivity
from furuta.studies.tuning.simulated_tuning import tuned_observer
from furuta_bringup.file_types import FIGURE
from furuta_bringup.options import MEASURED_SECONDS, json_option, model_options, print_json
from furuta_sim.settings.settings import load_settings, loop

# Multiples of the rig's noise.
NOISES = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)


@click.command()
@click.option(
    "--seconds",
    type=MEASURED_SECONDS,
    default=40.0,
    show_default=True,
    help="Simulated time of each run [s].",
)
@click.option(
    "--seeds",
    type=click.IntRange(1, 1000),
    default=10,
    show_default=True,
    help="Number of seeds per case.",
)
@click.option("--out", type=FIGURE, help="Draw the result.")
@model_options
@json_option
def command(
    seconds: float,
    seeds: int,
    out: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Measure how the remaining limit cycle grows with the sensor noise.

    Compares both estimators and five compensations. One of them is LuGre, tuned at the noise given
    by the parameters.
    """
    nominal = loop(load_settings(files, assignments))
    with Console(stderr=True, quiet=as_json).status("tuning, then simulating"):
        compensations = {
            name: nominal.observer._replace(compensation=name)
            for name in ("coulomb", "stiction", "lugre", "adaptive")
        }
        # The tuning needs the observed friction, also if the settings choose the other estimator.
        with_kalman = nominal._replace(estimator=nominal.estimator._replace(method="kalman"))
        compensations["lugre, tuned"] = tuned_observer(with_kalman, lambda *_: None)
        first = nominal.plant.seed
        rows = run_sensitivity(nominal, compensations, NOISES, range(first, first + seeds), seconds)
    if out is not None:
        from furuta.figures.sensitivity import draw_sensitivity

        draw_sensitivity(rows, encoder_resolution(nominal), out)
    if as_json:
        print_json({"rows": [row._asdict() for row in rows]})
    else:
        _print(rows)


def _print(rows: list[SensitivityRow]) -> None:
    table = Table(
        title=escape("arm, peak to peak [mrad], mean over the seeds, by noise"), box=SIMPLE
    )
    table.add_column("estimator", no_wrap=True)
    table.add_column("compensation", no_wrap=True)
    for noise in NOISES:
        table.add_column(escape(f"{noise:g}"), justify="right")
    for method, name in dict.fromkeys((row.method, row.compensation) for row in rows):
        line = [row for row in rows if (row.method, row.compensation) == (method, name)]
        table.add_row(method, name, *(f"{1e3 * row.mean:.1f}" for row in line))
    Console().print(table)
