"""``furuta run``."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from furuta.settings.nodes import HARDWARE_BRIDGE, NODES
from furuta_bringup.graph.scheduling import Scheduling
from furuta_bringup.option_types import PATH, FiniteRange
from furuta_bringup.options import namespace_option, option, parameter_options, rig_option
from furuta_bringup.printing import with_status

if TYPE_CHECKING:
    from furuta_bringup.graph.graph_plan import Graph
    from furuta_recordings.recorder_node import MakeRecorder


@click.command()
@option(
    "--plant",
    type=click.Choice(["sim", "hardware"]),
    default="sim",
    help="Simulated plant or real rig.",
)
@option(
    "--port",
    default="",
    metavar="PORT",
    needs=("--plant hardware",),
    help="Serial port of the rig; mock: an emulated rig.",
)
@rig_option
@option(
    "--read-only",
    is_flag=True,
    needs=("--plant hardware",),
    help="Only read the rig; never drive it.",
)
@option(
    "--lockstep",
    "clock",
    flag_value="lockstep",
    not_with=("--plant hardware",),
    help="Run in lock-step, as fast as the machine allows.",
)
@option(
    "--realtime",
    "clock",
    flag_value="realtime",
    not_with=("--plant hardware",),
    help="Run in real time (default).",
)
@option(
    "--without",
    multiple=True,
    type=click.Choice([node.name for node in NODES.values() if not node.controlled]),
    help="Leave out this node, so that your own can replace it; repeatable.",
)
@namespace_option
@option(
    "--processes",
    is_flag=True,
    not_with=("--seconds", "--priority", "--lock-memory"),
    help="Run each node in a process of its own.",
)
@option("--record", type=PATH, metavar="DIR", help="Record a bag into this directory.")
@option(
    "--topic",
    "topics",
    multiple=True,
    needs=("--record",),
    help="Record only this topic; repeatable.",
)
@option(
    "--seconds",
    type=FiniteRange(0, 1e9, min_open=True),
    help="Stop after this time of the plant or rig [s].",
)
@option(
    "--priority", type=click.IntRange(1, 99), help="Priority of the real-time scheduler SCHED_FIFO."
)
@option("--lock-memory", is_flag=True, help="Keep all memory from being swapped out.")
@parameter_options
def command(
    processes: bool,
    record: Path | None,
    topics: tuple[str, ...],
    seconds: float | None,
    priority: int | None,
    lock_memory: bool,
    **graph_options: Any,
) -> None:
    """Run the graph until Ctrl-C.

    With --priority or --lock-memory, the command first prints whether the system granted it.
    """
    scheduling = Scheduling(priority or 0, lock_memory)
    with with_status("loading"):
        from furuta_bringup.graph.processes import run_processes
        from furuta_bringup.graph.run_composed import run_hardware, run_simulated
        from furuta_ros.process import StopSignal

        graph = planned_graph(seconds=seconds, **graph_options)
        hardware = graph.controlled == HARDWARE_BRIDGE
        lockstep = not hardware and graph.settings["plant"].get("clock") == "lockstep"
        recorder = _recorder(record, topics, graph, stamped=lockstep)
    if processes:
        sys.exit(run_processes(graph, StopSignal(), recorder))
    if hardware:
        run_hardware(graph, recorder, seconds, scheduling)
    else:
        run_simulated(graph, recorder, seconds, scheduling)


def planned_graph(
    *,
    plant: str,
    port: str,
    rig: str,
    read_only: bool,
    clock: str | None,
    without: tuple[str, ...],
    namespace: str,
    seconds: float | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    **_: Any,
) -> Graph:
    """The graph that options of the command describe; how it runs does not matter.

    Raises:
        ParameterError: Options or parameters are wrong, or do not fit together.
    """
    from furuta_bringup.graph.graph_plan import GraphOptions, plan_graph

    hardware = plant == "hardware"
    end = None if hardware else seconds
    options = GraphOptions(hardware, rig, port, read_only, clock or "", without, namespace, end)
    return plan_graph(options, files, assignments)


def _recorder(
    path: Path | None, topics: tuple[str, ...], graph: Graph, stamped: bool
) -> MakeRecorder | None:
    """A function that makes the recorder, if there is something to record."""
    if path is None:
        return None
    from furuta_bringup.parameter_files import settings_file
    from furuta_recordings.bags.writer import check_new_bag
    from furuta_recordings.recorder_node import RecorderNode, chosen_topics

    parameters = settings_file(graph.settings)
    make = partial(RecorderNode, path, stamped, chosen_topics(topics), parameters)
    check_new_bag(path)
    return make
