"""The description of the graph: its nodes, and the checks that concern several of them.

Everything that starts, configures or tests the graph reads it: the composed graph, one process
per node, the launch file, the command line, parameter files. It imports no ROS; a node's class and
its parameters are imported when they are needed.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from importlib import import_module
from math import pi
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from furuta_model.parameters import ParameterError, values

if TYPE_CHECKING:
    from furuta_control.control import ControllerParameters
    from furuta_control.estimation import EstimatorParameters
    from furuta_friction.joint_observer import ObserverNodeParameters


class NodeDescription(NamedTuple):
    """A node: its name, which is that of its executable too, its parameters and its class.

    Both classes are ``module:class``. A node with ``controlled`` is the controlled system: a graph
    has exactly one of these.
    """

    name: str
    parameter_class: str
    node_class: str
    controlled: bool = False

    @property
    def package(self) -> str:
        """The package that holds the node and its executable."""
        return self.node_class.partition(".")[0]

    @property
    def executable(self) -> str:
        """The executable that runs the node."""
        return self.name

    @property
    def parameters(self) -> type[NamedTuple]:
        """The group of the node's parameters."""
        return cast(type[NamedTuple], _imported(self.parameter_class))

    def load_class(self) -> Any:
        """The node's class, a function of a list of parameter overrides."""
        return _imported(self.node_class)


def _imported(named: str) -> Any:
    module, _, name = named.partition(":")
    return getattr(import_module(module), name)


PLANT = "plant"
ESTIMATOR = "estimator"
FRICTION_OBSERVER = "friction_observer"
CONTROLLER = "controller"
HARDWARE_BRIDGE = "hardware_bridge"

NODES: dict[str, NodeDescription] = {
    node.name: node
    for node in (
        NodeDescription(
            PLANT,
            "furuta_sim.parameters:PlantNodeParameters",
            "furuta_sim.plant_node:PlantNode",
            controlled=True,
        ),
        NodeDescription(
            ESTIMATOR,
            "furuta_control.estimation:EstimatorParameters",
            "furuta_control.estimator_node:EstimatorNode",
        ),
        NodeDescription(
            FRICTION_OBSERVER,
            "furuta_friction.joint_observer:ObserverNodeParameters",
            "furuta_friction.friction_observer_node:FrictionObserverNode",
        ),
        NodeDescription(
            CONTROLLER,
            "furuta_control.control:ControllerParameters",
            "furuta_control.controller_node:ControllerNode",
        ),
        NodeDescription(
            HARDWARE_BRIDGE,
            "furuta_hw.bridge.parameters:BridgeParameters",
            "furuta_hw.bridge.bridge_node:HardwareBridgeNode",
            controlled=True,
        ),
    )
}


def graph_nodes(
    controlled: str = PLANT, without: Collection[str] = ()
) -> tuple[NodeDescription, ...]:
    """The nodes of a graph: the controlled system first, then the others but ``without``."""
    others = [node for node in NODES.values() if not node.controlled]
    names = [node.name for node in others]
    for name in without:
        if name not in names:
            raise ParameterError(f"the graph can run without {', '.join(names)}; given {name}")
    return (NODES[controlled], *(node for node in others if node.name not in without))


def check_graph(parameters: Mapping[str, Any]) -> None:
    """Check that the parameters of the nodes of a graph fit together; some nodes may be left out.

    Raises:
        ParameterError: They do not.
    """
    _check_sample_times(parameters)
    _check_joint(parameters.get(FRICTION_OBSERVER))
    estimator = parameters.get(ESTIMATOR)
    if estimator is not None:
        _check_whole_circle(parameters.get(CONTROLLER), estimator)


def _check_sample_times(parameters: Mapping[str, Any]) -> None:
    """All nodes must have the same sample time."""
    given = {node: values(group) for node, group in parameters.items()}
    times = {node: of["sample_time"] for node, of in given.items() if "sample_time" in of}
    if len(set(times.values())) > 1:
        listed = ", ".join(f"{node} {time:g} s" for node, time in times.items())
        raise ParameterError(f"sample_time must be the same for all nodes, given {listed}")


def _check_joint(node: ObserverNodeParameters | None) -> None:
    """The friction observer is that of the arm."""
    if node is not None and node.joint != "arm":
        raise ParameterError(f"joint must be arm in the pendulum's graph, given {node.joint}")


def _check_whole_circle(
    controller: ControllerParameters | None, estimator: EstimatorParameters
) -> None:
    """The controller can swing up only with a sensor and an estimator for any pendulum angle."""
    if controller is None or controller.mode != "swing_up":
        return
    sensors = estimator.sensors
    if not sensors.ideal and sensors.potentiometer_range < pi:
        raise ParameterError(
            "mode swing_up needs a pendulum sensor of a full turn: sensors.potentiometer_range "
            f"must be at least {pi:.6f} rad, given {sensors.potentiometer_range:g} rad"
        )
    if not estimator.chosen.covers_circle:
        raise ParameterError(
            "mode swing_up needs an estimator of the whole circle, such as "
            f"estimator.method=whole_circle; given {estimator.method}"
        )
