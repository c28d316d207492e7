"""Which graph to start: its nodes, their parameters and its namespace.

The command line and the launch file both make their graph here, so that both start the same one.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from furuta_model.parameters import build, values
from furuta_ros.topic_names import full_namespace
from furuta_sim.settings.nodes import HARDWARE_BRIDGE, PLANT, NodeDescription, graph_nodes
from furuta_sim.settings.rigs import check_sample_time, find_rig, rig_file
from furuta_sim.settings.settings import (
    Settings,
    collect_settings,
    load_settings,
    merge_settings,
    rig_settings,
)


class GraphOptions(NamedTuple):
    """What a user chooses besides parameters; an empty value leaves the choice to them."""

    hardware: bool = False  # a real rig instead of the simulated plant
    rig: str = ""  # name or file
    port: str = ""
    read_only: bool = False  # never drive the rig
    clock: str = ""  # of the simulated plant
    without: tuple[str, ...] = ()  # nodes to leave out
    namespace: str = ""


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
    files, assignments = list(files), list(assignments)
    controlled = HARDWARE_BRIDGE if options.hardware else PLANT
    graph_nodes(controlled, options.without)  # raises an error for a wrong name
    rig = options.rig
    if options.hardware and not rig:
        rig = collect_settings(files, assignments, base)[HARDWARE_BRIDGE].get("rig", "")
    if rig:
        of_rig = rig_settings(find_rig(rig))
        base = of_rig if base is None else merge_settings(base, of_rig)
    settings = load_settings(files, assignments, base)
    settings[controlled] |= _bridge_settings(options, rig) if options.hardware else {}
    settings[controlled] |= {"clock": options.clock} if options.clock else {}
    if options.hardware:
        check_sample_time(find_rig(rig) if rig else None, settings)
    return Graph(controlled, options.without, settings, full_namespace(options.namespace))


def _bridge_settings(options: GraphOptions, rig: str) -> dict[str, Any]:
    """The bridge connects by itself; it is armed by hand."""
    chosen: dict[str, Any] = {
        "autostart": "inactive" if options.read_only else "active",
        "read_only": options.read_only,
    }
    chosen |= {"port": options.port} if options.port else {}
    return chosen | ({"rig": str(rig_file(rig))} if rig else {})
