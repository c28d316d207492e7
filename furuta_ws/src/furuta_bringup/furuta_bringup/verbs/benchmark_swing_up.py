"""``furuta benchmark-swing-up``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from furuta.studies.swing_up.benchmark import RIGS, benchmark
from furuta.studies.swing_up.rig_loop import swing_up_settings
from furuta_bringup.options import SEED, json_option, parameter_options, print_json
from furuta_sim.settings.rigs import find_rig
from furuta_sim.settings.settings import load_settings, loop


@click.command()
@click.option(
    "--rig",
    multiple=True,
    metavar="NAME",
    help=f"Name or file of a rig, repeatable; default: {', '.join(RIGS)}.",
)
@click.option("--seed", type=SEED, default=1, show_default=True, help="Seed of noise and pushes.")
@parameter_options
@json_option
def command(
    rig: tuple[str, ...],
    seed: int,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Score swing-up by the criteria of the double-pendulum competition, without ROS.

    One undisturbed swing-up, the robustness against six kinds of disturbance, and the time upright
    within 60 s with a push that topples the pendulum every 10 s.
    """
    console = Console(stderr=True, quiet=as_json or not sys.stderr.isatty())
    rows = []
    for name in rig or RIGS:
        settings = swing_up_settings(find_rig(name))
        settings["controller"]["swing_up.recover"] = True
        with console.status(name):
            found = benchmark(loop(load_settings(files, assignments, settings)), seed)
        rows.append({"rig": name, **{part: each._asdict() for part, each in found.items()}})
    if as_json:
        print_json({"rigs": rows})
    else:
        _print(rows)


def _print(rows: list[dict[str, Any]]) -> None:
    """One table per part, one column per rig."""
    for part in [each for each in rows[0] if each != "rig"]:
        table = Table(title=part.replace("_", " "), box=SIMPLE)
        table.add_column("", no_wrap=True)
        for row in rows:
            table.add_column(row["rig"], justify="right")
        for name in rows[0][part]:
            table.add_row(name, *(f"{row[part][name]:.4g}" for row in rows))
        Console().print(table)
