"""``furuta run``."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import Any

import click

from furuta_cli.options import model_options
from furuta_graph.parameter_files import settings_file
from furuta_graph.processes import HARDWARE, run_processes
from furuta_graph.rigs import find_rig, rig_file, rig_settings
from furuta_graph.run import run_composed, run_on_hardware
from furuta_graph.settings import Settings, load_settings
from furuta_model.parameters import ParameterError
from furuta_recordings.recorder_node import MakeRecorder, RecorderNode, chosen_topics
from furuta_ros.scheduling import Scheduling
from furuta_ros.spinning import StopSignal


@click.command()
@click.option("--plant", type=click.Choice(["sim", "hardware"]), default="sim", show_default=True)
@click.option("--port", metavar="PORT", help="Serial port of the rig, or mock.")
@click.option("--rig", metavar="NAME|FILE", help="The rig; its model goes to all nodes.")
@click.option("--read-only", is_flag=True, help="Read the rig, never drive it.")
@click.option("--lockstep", "clock", flag_value="lockstep", help="As fast as the machine allows.")
@click.option("--realtime", "clock", flag_value="realtime", help="At the sample time (default).")
@click.option("--processes", is_flag=True, help="One process per node instead of one for all.")
@click.option("--record", type=click.Path(path_type=Path), metavar="DIR", help="Record a bag.")
@click.option("--topic", "topics", multiple=True, help="Record only this topic; repeatable.")
@click.option("--seconds", type=float, help="StopSignal after this pendulum time.")
@click.option("--priority", type=click.IntRange(1, 99), help="SCHED_FIFO priority (real time).")
@click.option("--cores", metavar="N,N", help="Run on these cores only.")
@click.option("--lock-memory", is_flag=True, help="Keep all memory from being swapped out.")
@click.option("--no-gc", is_flag=True, help="Switch Python's garbage collector off.")
@click.option("--timing", type=click.Path(path_type=Path), metavar="FILE.csv",
    help="Write how late samples were.")  # fmt: skip
@model_options
def command(
    plant: str,
    port: str | None,
    rig: str | None,
    read_only: bool,
    clock: str | None,
    processes: bool,
    record: Path | None,
    topics: tuple[str, ...],
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
    settings = load_settings(files, assignments, rig_settings(find_rig(rig)) if rig else None)
    scheduling = Scheduling(priority or 0, _cores(cores), lock_memory, not no_gc)
    if seconds is not None and not seconds > 0:
        raise ParameterError(f"--seconds must be above 0, given {seconds:g}")
    if processes and (seconds is not None or timing or scheduling != Scheduling()):
        raise ParameterError("--processes goes with neither --seconds, --timing nor scheduling")
    recorder = partial(_recorder, record, topics, settings)
    if plant == "hardware":
        if clock or timing:
            raise ParameterError("a rig keeps its own time: no --lockstep, --realtime or --timing")
        _on_a_rig(settings["hardware_bridge"], port, rig, read_only)
        if processes:
            sys.exit(run_processes(settings, StopSignal(), HARDWARE, recorder(stamped=False)))
        run_on_hardware(settings, recorder(stamped=False), seconds, scheduling)
        return
    if port or read_only:
        raise ParameterError("--port and --read-only go with --plant hardware")
    if clock:
        settings["plant"]["clock"] = clock
    if seconds is not None:
        settings["plant"]["run_until"] = seconds
    if timing is not None and settings["plant"].get("clock") == "lockstep":
        raise ParameterError("--timing is of real time; in lock-step nothing is late")
    record_it = recorder(stamped=settings["plant"].get("clock") == "lockstep")
    if processes:
        sys.exit(run_processes(settings, StopSignal(), record=record_it))
    run_composed(settings, record_it, seconds, scheduling, timing)


def _recorder(
    path: Path | None, topics: tuple[str, ...], settings: Settings, stamped: bool
) -> MakeRecorder | None:
    """What makes the recorder that was asked for."""
    if path is None:
        if topics:
            raise ParameterError("--topic chooses what --record records")
        return None
    return partial(RecorderNode, path, stamped, chosen_topics(topics), settings_file(settings))


def _on_a_rig(bridge: dict[str, Any], port: str | None, rig: str | None, read_only: bool) -> None:
    """Let the bridge start by itself, on this port and rig."""
    bridge |= {"autostart": "inactive" if read_only else "active", "read_only": read_only}
    bridge |= ({"port": port} if port else {}) | ({"rig": str(rig_file(rig))} if rig else {})


def _cores(text: str | None) -> tuple[int, ...]:
    try:
        return tuple(int(each) for each in text.split(",")) if text else ()
    except ValueError:
        raise ParameterError(f"--cores must be numbers such as 0,1, given {text!r}") from None
