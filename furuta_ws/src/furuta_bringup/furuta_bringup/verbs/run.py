"""``furuta run``."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from furuta_bringup.composed import run_composed
from furuta_bringup.processes import run_processes
from furuta_bringup.settings import gather
from furuta_model.parameters import ParameterError
from furuta_ros.spinning import Stop

from ..options import model_options


@click.command()
@click.option("--plant", type=click.Choice(["sim", "hardware"]), default="sim", show_default=True)
@click.option("--lockstep", "clock", flag_value="lockstep", help="As fast as the machine allows.")
@click.option("--realtime", "clock", flag_value="realtime", help="At the sample time (default).")
@click.option("--processes", is_flag=True, help="One process per node instead of one for all.")
@click.option("--record", type=click.Path(path_type=Path), metavar="DIR", help="Record a bag.")
@click.option("--seconds", type=float, help="Stop after this pendulum time.")
@model_options
def command(
    plant: str,
    clock: str | None,
    processes: bool,
    record: Path | None,
    seconds: float | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
) -> None:
    """Run the graph until Ctrl-C."""
    if plant == "hardware":
        raise ParameterError("--plant hardware: this version has no hardware bridge yet")
    settings = gather(files, assignments)
    if clock:
        settings["plant"]["clock"] = clock
    if seconds is not None:
        if not seconds > 0:
            raise ParameterError(f"--seconds must be above 0, given {seconds:g}")
        settings["plant"]["run_until"] = seconds
    if processes:
        if record or seconds is not None:
            raise ParameterError("--processes goes with neither --record nor --seconds")
        sys.exit(run_processes(settings, Stop()))
    run_composed(settings, record, seconds)
