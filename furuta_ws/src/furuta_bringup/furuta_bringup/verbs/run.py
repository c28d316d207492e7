"""``furuta run``."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from furuta_bringup.composed import run_composed
from furuta_bringup.processes import run_processes
from furuta_bringup.settings import gather
from furuta_model.parameters import ParameterError
from furuta_ros.scheduling import Scheduling
from furuta_ros.spinning import Stop

from ..options import model_options


@click.command()
@click.option("--plant", type=click.Choice(["sim", "hardware"]), default="sim", show_default=True)
@click.option("--lockstep", "clock", flag_value="lockstep", help="As fast as the machine allows.")
@click.option("--realtime", "clock", flag_value="realtime", help="At the sample time (default).")
@click.option("--processes", is_flag=True, help="One process per node instead of one for all.")
@click.option("--record", type=click.Path(path_type=Path), metavar="DIR", help="Record a bag.")
@click.option("--seconds", type=float, help="Stop after this pendulum time.")
@click.option("--priority", type=click.IntRange(1, 99), help="SCHED_FIFO priority (real time).")
@click.option("--cores", metavar="N,N", help="Run on these cores only.")
@click.option("--lock-memory", is_flag=True, help="Keep all memory from being swapped out.")
@click.option("--no-gc", is_flag=True, help="Switch Python's garbage collector off.")
@click.option("--timing", type=click.Path(path_type=Path), metavar="FILE.csv",
    help="Write how late samples were.")  # fmt: skip
@model_options
def command(
    plant: str,
    clock: str | None,
    processes: bool,
    record: Path | None,
    seconds: float | None,
    priority: int | None,
    cores: str | None,
    lock_memory: bool,
    no_gc: bool,
    timing: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
) -> None:
    """Run the graph until Ctrl-C.

    What the system grants of --priority, --cores and --lock-memory is printed at the start.
    """
    if plant == "hardware":
        raise ParameterError("--plant hardware: this version has no hardware bridge yet")
    settings = gather(files, assignments)
    if clock:
        settings["plant"]["clock"] = clock
    if seconds is not None:
        if not seconds > 0:
            raise ParameterError(f"--seconds must be above 0, given {seconds:g}")
        settings["plant"]["run_until"] = seconds
    scheduling = Scheduling(priority or 0, _cores(cores), lock_memory, not no_gc)
    if timing is not None and settings["plant"].get("clock") == "lockstep":
        raise ParameterError("--timing is of real time; in lock-step nothing is late")
    if processes:
        if record or seconds is not None or timing or scheduling != Scheduling():
            raise ParameterError(
                "--processes goes with neither --record, --seconds, --timing nor scheduling"
            )
        sys.exit(run_processes(settings, Stop()))
    run_composed(settings, record, seconds, scheduling, timing)


def _cores(text: str | None) -> tuple[int, ...]:
    try:
        return tuple(int(each) for each in text.split(",")) if text else ()
    except ValueError:
        raise ParameterError(f"--cores must be numbers such as 0,1, given {text!r}") from None
