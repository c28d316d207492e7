"""The description of the graph: its nodes, and the checks that concern several of them.

Everything that starts, configures or tests the graph reads it: the composed graph, one process
per node, the launch file, the command line, parameter files. It imports no ROS; a node's class is
imported when it is needed.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from importlib import import_module
from math import pi
from typing import Any, NamedTuple

from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_hw.bridge.parameters import BridgeParameters
from furuta_model.parameters import ParameterError, values
from furuta_sim.parameters import PlantNodeParameters


class NodeDescription(NamedTuple):
    """A node: its name, the package and executable that run it, its parameters, its class.

    ``node_class`` is ``module:class``. A node with ``controlled`` is the controlled system: a graph
    has exactly one of these.
    """

    name: str
    package: str
    executable: str
    parameters: type[NamedTuple]
    node_class: str
    controlled: bool = False

    def load_class(self) -> Any:
        """The node's class, a function of a list of parameter overrides."""
        module, _, name = self.node_class.partition(":")
        return getattr(import_module(module), name)


PLANT = "plant"
HARDWARE_BRIDGE = "hardware_bridge"

NODES: dict[str, NodeDescription] = {
    each.name: each
    for each in (
        NodeDescription(
            PLANT,
            "furuta_sim",
            "plant",
            PlantNodeParameters,
            "furuta_sim.plant_node:PlantNode",
            controlled=True,
        ),
        NodeDescription(
            "estimator",
            "furuta_control",
            "estimator",
            EstimatorParameters,
            "furuta_control.estimator_node:EstimatorNode",
        ),
        NodeDescription(
            "friction_observer",
            "furuta_friction",
            "friction_observer",
            ObserverParameters,
            "furuta_friction.friction_observer_node:FrictionObserverNode",
        ),
        NodeDescription(
            "controller",
            "furuta_control",
            "controller",
            ControllerParameters,
            "furuta_control.controller_node:ControllerNode",
        ),
        NodeDescription(
            HARDWARE_BRIDGE,
            "furuta_hw",
            "hardware_bridge",
            BridgeParameters,
            "furuta_hw.bridge.bridge_node:HardwareBridgeNode",
            controlled=True,
        ),
    )
}


def graph_nodes(
    controlled: str = PLANT, without: Collection[str] = ()
) -> tuple[NodeDescription, ...]:
    """The nodes of a graph: the controlled system first, then the others but ``without``."""
    others = [each for each in NODES.values() if not each.controlled]
    for name in without:
        if name not in (each.name for each in others):
            names = ", ".join(each.name for each in others)
            raise ParameterError(f"the graph can run without {names}; given {name}")
    return (NODES[controlled], *(each for each in others if each.name not in without))


def check_graph(parameters: Mapping[str, Any]) -> None:
    """Check that the parameters of the nodes of a graph fit together.

    Raises:
        ParameterError: They do not.
    """
    check_sample_times(parameters)
    check_observed_friction(parameters)
    check_whole_circle(parameters)


def check_sample_times(parameters: Mapping[str, Any]) -> None:
    """All nodes must have the same sample time."""
    given = {node: values(each) for node, each in parameters.items()}
    times = {node: each["sample_time"] for node, each in given.items() if "sample_time" in each}
    if len(set(times.values())) > 1:
        listed = ", ".join(f"{node} {time:g} s" for node, time in times.items())
        raise ParameterError(f"sample_time must be the same for all nodes, given {listed}")


def check_observed_friction(parameters: Mapping[str, Any]) -> None:
    """Some compensations need an estimator that estimates the friction too."""
    observer, estimator = parameters.get("friction_observer"), parameters.get("estimator")
    if observer is None or estimator is None:
        return
    if observer.chosen.needs_observed_friction and not estimator.chosen.observes_friction:
        raise ParameterError(
            f"compensation {observer.compensation} needs an estimator that observes the friction, "
            f"such as estimator.method=kalman; given {estimator.method}"
        )


def check_whole_circle(parameters: Mapping[str, Any]) -> None:
    """The controller can swing up only with a sensor and an estimator for any pendulum angle."""
    controller, estimator = parameters.get("controller"), parameters.get("estimator")
    if controller is None or estimator is None or controller.mode != "swing_up":
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
