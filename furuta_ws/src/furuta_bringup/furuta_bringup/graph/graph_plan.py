"""Which graph to start: its nodes, their parameters and its namespace.

The command line and the launch file both make their graph here, so that both start the same one.
"""

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from furuta.settings.nodes import (
    ESTIMATOR,
    HARDWARE_BRIDGE,
    PLANT,
    NodeDescription,
    graph_nodes,
)
from furuta.settings.settings import (
    Settings,
    collect_settings,
    default_settings,
    load_settings,
    merge_settings,
    parameters_of,
    require_agreement,
    rig_settings,
)
from furuta_hw.rigs.known_rigs import find_rig, rig_file
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import ParameterError, build, values
from furuta_ros.middleware import ros_domain
from furuta_ros.one_graph import full_namespace, view_command


class GraphOptions(NamedTuple):
    """What a user chooses besides parameters; an empty value leaves the choice to them."""

    hardware: bool = False  # a real rig instead of the simulated plant
    rig: str = ""  # name or file
    port: str = ""
    read_only: bool = False  # never drive the rig
    clock: str = ""  # of the simulated plant
    without: tuple[str, ...] = ()  # nodes to leave out
    namespace: str = ""
    seconds: float | None = None  # time of the simulated plant at which it pauses


class Graph(NamedTuple):
    """A graph to start: its controlled system, the nodes that are left out, all parameters."""

    controlled: str
    without: tuple[str, ...]
    settings: Settings
    namespace: str = ""

    @property
    def nodes(self) -> tuple[NodeDescription, ...]:
        """The nodes to start; the controlled system is the first."""
        return graph_nodes(self.controlled, self.without)

    def parameters(self, node: NodeDescription) -> dict[str, Any]:
        """All parameters of a node by name."""
        return values(build(node.parameters, self.settings[node.name]))


def plan_graph(
    options: GraphOptions,
    files: Iterable[Path] = (),
    assignments: Iterable[str] = (),
    base: Settings | None = None,
) -> Graph:
    """The graph that the options, parameter files and assignments describe.

    The rig determines model, friction, sensors, sample time and limits of every node. It takes
    precedence over ``base``; parameter files and assignments take precedence over the rig.

    Raises:
        ParameterError: A parameter or an option is wrong, or the nodes do not fit together.
    """
    files, assignments, meant = list(files), list(assignments), _meant(options)
    require_agreement(assignments, meant)
    assignments += meant.values()
    controlled = HARDWARE_BRIDGE if options.hardware else PLANT
    graph_nodes(controlled, options.without)  # raises an error for a wrong name
    namespace = full_namespace(options.namespace)
    name = options.rig
    if options.hardware and not name:
        given = collect_settings(files, assignments, base, namespace, options.without)
        name = given[HARDWARE_BRIDGE].get("rig", "")
    rig = find_rig(name) if name else Rig()
    if name:
        base = merge_settings(base or default_settings(), rig_settings(rig))
    settings = load_settings(files, assignments, base, namespace, options.without)
    if options.hardware:
        bridge = settings[HARDWARE_BRIDGE]
        if name:
            bridge["rig"] = str(rig_file(name))
        if f"{HARDWARE_BRIDGE}.autostart" not in settings.chosen():
            # The bridge connects by itself; it is armed by hand.
            bridge["autostart"] = "inactive" if bridge.get("read_only") else "active"
        of_rig, of_nodes = rig.line.sample_time, parameters_of(settings)[ESTIMATOR].sample_time
        if of_rig != of_nodes:
            raise ParameterError(
                f"the rig's sample_time is {of_rig:g} s, that of the nodes is {of_nodes:g} s"
            )
    return Graph(controlled, options.without, settings, namespace)


def tell_running(graph: Graph, state: str = "running") -> None:
    """Say on standard error which graph runs, what ends it and what shows it."""
    settings = graph.settings[graph.controlled]
    clock = "lock-step" if settings.get("clock") == "lockstep" else "real time"
    what = "hardware bridge" if graph.controlled == HARDWARE_BRIDGE else f"simulation in {clock}"
    print(
        f"{state}: {what}, namespace {graph.namespace or '/'}, ROS domain {ros_domain()}; "
        f"Ctrl-C ends it, {view_command(graph.namespace)} shows it",
        file=sys.stderr,
    )


def _meant(options: GraphOptions) -> dict[str, str]:
    """The assignments that options stand for, by the name of the option."""
    given = {
        "--port": f"{HARDWARE_BRIDGE}.port={json.dumps(options.port)}" if options.port else "",
        "--read-only": f"{HARDWARE_BRIDGE}.read_only=true" if options.read_only else "",
        f"--{options.clock}": f"{PLANT}.clock={options.clock}" if options.clock else "",
        "--seconds": "" if options.seconds is None else f"{PLANT}.run_until={options.seconds}",
    }
    return {option: assignment for option, assignment in given.items() if assignment}
