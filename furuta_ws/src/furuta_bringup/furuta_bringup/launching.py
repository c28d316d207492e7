"""The graph for ``ros2 launch``: launch arguments to processes, without importing ``launch``."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from furuta.settings.nodes import FRICTION_OBSERVER, NODES, PLANT
from furuta.settings.settings import collect_settings
from furuta_bringup.graph.graph_plan import Graph, GraphOptions, plan_graph
from furuta_bringup.graph.processes import NodeProcess, node_processes
from furuta_bringup.parameter_files import settings_file
from furuta_description.robot_description import display_nodes
from furuta_hw.rigs.known_rigs import config_directory
from furuta_model.accepted_parts import accept_parts, parts_in
from furuta_model.parameters import ParameterError
from furuta_recordings.bags.writer import check_new_bag

LOG_LEVELS = ("debug", "info", "warn", "error", "fatal")
TRUTH = {"true": True, "false": False}
# Time between the end of a node and its next start [s].
RESPAWN_DELAY = 1.0


def launched_nodes(
    params_file: str = "",
    clock: str = "",
    port: str = "",
    rig: str = "",
    namespace: str = "",
    without: str = "",
    compensation: str = "",
    record: str = "",
    own_parts: str = "",
    log_level: str = "info",
    respawn: str = "false",
    view: str = "false",
) -> list[dict[str, Any]]:
    """Arguments of ``launch_ros.actions.Node`` for each node; the controlled system is the first.

    The installed parameter files are the defaults; the rig takes precedence over them,
    ``params_file`` over the rig, and ``clock`` and ``compensation`` over ``params_file``. With
    ``port`` the bridge to a rig replaces the simulated plant. ``view`` adds what shows it in RViz.

    Raises:
        ParameterError: An argument is wrong; nothing must be started.
    """
    check_choice("log_level", log_level, LOG_LEVELS)
    check_choice("respawn", respawn, TRUTH)
    check_choice("view", view, TRUTH)
    accept_parts(parts_in(own_parts))
    if port and clock:
        raise ParameterError(f"a rig has its own clock: no clock with port, given {clock!r}")
    options = GraphOptions(
        hardware=bool(port),
        rig=rig,
        port=port,
        clock=clock,
        without=tuple(name.strip() for name in without.split(",") if name.strip()),
        namespace=namespace,
    )
    graph = _graph(options, params_file, compensation)
    plant = graph.settings[PLANT] if graph.controlled == PLANT else {}
    lockstep = plant.get("clock") == "lockstep"
    controlled, *others = node_processes(graph)
    return [
        _node_arguments(controlled, log_level),
        *(_node_arguments(node, log_level, TRUTH[respawn]) for node in others),
        *(_node_arguments(node, log_level) for node in _recorders(graph, record, lockstep)),
        *(display_nodes(rig, namespace, lockstep) if TRUTH[view] else ()),
    ]


def _node_arguments(process: NodeProcess, log_level: str, respawn: bool = False) -> dict[str, Any]:
    return {
        "package": process.package,
        "executable": process.executable,
        "name": process.name,
        "namespace": process.namespace or None,
        "output": "screen",
        "ros_arguments": [*process.parameter_arguments, "--log-level", log_level],
        "respawn": respawn,
        "respawn_delay": RESPAWN_DELAY,
    }


def _graph(options: GraphOptions, params_file: str, compensation: str) -> Graph:
    """The graph with its parameters."""
    defaults = [config_directory() / f"{node}.yaml" for node in NODES]
    files = [Path(params_file)] if params_file else []
    chosen = [f"{FRICTION_OBSERVER}.compensation={compensation}"] if compensation else []
    if compensation and FRICTION_OBSERVER in options.without:
        raise ParameterError(
            f"compensation {compensation} needs the node {FRICTION_OBSERVER}, which is left out"
        )
    return plan_graph(options, files, chosen, base=collect_settings(defaults, []))


def _recorders(graph: Graph, directory: str, lockstep: bool) -> list[NodeProcess]:
    """The process that records into a directory, if one is given."""
    if not directory:
        return []
    check_new_bag(Path(directory))
    parameters = {
        "directory": str(Path(directory).absolute()),
        "stamped": lockstep,
        "graph_parameters": settings_file(graph.settings),
    }
    return [NodeProcess("furuta_recordings", "recorder", "recorder", graph.namespace, parameters)]


def check_choice(name: str, given: str, allowed: Iterable[str]) -> None:
    """Reject the value of a launch argument that is not one of ``allowed``."""
    if given not in allowed:
        raise ParameterError(f"{name} must be one of {', '.join(allowed)}, given {given!r}")
