"""The graph for ``ros2 launch``: launch arguments to processes, without importing ``launch``."""

from __future__ import annotations

from pathlib import Path

from furuta_graph.description import NODES
from furuta_graph.graph_plan import GraphOptions, plan_graph
from furuta_graph.processes import NodeProcess, node_processes
from furuta_graph.rigs import config_directory
from furuta_graph.settings import collect_settings


def launched_processes(
    params_file: str = "",
    clock: str = "",
    port: str = "",
    rig: str = "",
    namespace: str = "",
    without: str = "",
) -> list[NodeProcess]:
    """The processes that the launch file starts; the controlled system is the first.

    The installed parameter files are the defaults; the rig takes precedence over them, and
    ``params_file`` over the rig. With ``port`` the bridge to a rig replaces the simulated plant.

    Raises:
        ParameterError: An argument is wrong; nothing must be started.
    """
    defaults = [config_directory() / f"{node}.yaml" for node in NODES]
    options = GraphOptions(
        hardware=bool(port),
        rig=rig,
        port=port,
        clock="" if port else clock,
        without=tuple(each.strip() for each in without.split(",") if each.strip()),
        namespace=namespace,
    )
    files = [Path(params_file)] if params_file else []
    return node_processes(plan_graph(options, files, base=collect_settings(defaults, [])))
