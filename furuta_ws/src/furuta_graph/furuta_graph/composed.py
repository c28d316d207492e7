"""The whole graph in one process, on one executor: the node classes that also run alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from time import monotonic, sleep
from typing import ClassVar, cast

from rclpy.clock import Clock, ClockType
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.parameter import Parameter

from furuta_control.controller_node import ControllerNode
from furuta_control.estimator_node import EstimatorNode
from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_graph.settings import Settings
from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_recordings.recorder_node import COLLECT_EVERY, MakeRecorder
from furuta_ros.errors import UserError
from furuta_ros.spinning import executor_of, settle_memory, spin_until
from furuta_sim.plant_node import PlantNode

# Longest wait for the nodes of this process to find each other [s].
DISCOVERY_TIMEOUT = 30.0


class ComposedGraph:
    """Estimator, friction observer and controller around what they control, with others beside.

    Time starts once all know each other and the bag, if they are to ``record``, is on the disk, so
    it holds the first sample. The recorder collects between samples; it ends with the graph.
    """

    # What is controlled, and its node's name.
    controlled: ClassVar[Callable[[list[Parameter]], Node]]
    name: ClassVar[str]

    def __init__(
        self,
        settings: Settings,
        others: Iterable[Node] = (),
        record: MakeRecorder | None = None,
    ) -> None:
        def overrides(node: str) -> list[Parameter]:
            return [Parameter(name, value=value) for name, value in settings[node].items()]

        self.estimator = EstimatorNode(overrides("estimator"))
        self.friction_observer = FrictionObserverNode(overrides("friction_observer"))
        self.controller = ControllerNode(overrides("controller"))
        self.nodes: list[Node] = [
            type(self).controlled(overrides(self.name)),
            self.estimator,
            self.friction_observer,
            self.controller,
            *others,
        ]
        self._recorder = record() if record is not None else None
        if self._recorder is not None:
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self.nodes[0].create_timer(COLLECT_EVERY, self._recorder.collect, clock=steady)
        _wait_until_matched([*self.nodes, *([self._recorder] if self._recorder else [])])
        self.executor: Executor = executor_of(self.nodes)
        settle_memory()

    def close(self) -> None:
        """End the nodes, and the recording first."""
        self.executor.shutdown()
        if self._recorder is not None:
            self._recorder.destroy_node()
        for node in self.nodes:
            node.destroy_node()


class SimulatedGraph(ComposedGraph):
    """The ring around the simulated plant."""

    controlled, name = PlantNode, "plant"

    @property
    def plant(self) -> PlantNode:
        """The plant's node."""
        return cast(PlantNode, self.nodes[0])

    def run_until(self, seconds: float) -> None:
        """Spin until the plant has paused at ``seconds`` (its ``run_until`` set to that)."""
        spin_until(self.executor, lambda: self.plant.time >= seconds - 1e-9 or self.plant.paused)


class HardwareGraph(ComposedGraph):
    """The ring around a real rig."""

    controlled, name = HardwareBridgeNode, "hardware_bridge"

    @property
    def bridge(self) -> HardwareBridgeNode:
        """The bridge's node."""
        return cast(HardwareBridgeNode, self.nodes[0])


def _wait_until_matched(nodes: list[Node]) -> None:
    """Return once every subscription of these nodes is known to every publisher among them.

    In lock-step a message that a subscriber misses would stop the run, so time starts after.
    """
    wanted = {
        publisher: sum(
            subscription.topic_name == publisher.topic_name
            for node in nodes
            for subscription in node.subscriptions
        )
        for node in nodes
        for publisher in node.publishers
    }
    deadline = monotonic() + DISCOVERY_TIMEOUT
    while any(each.get_subscription_count() < count for each, count in wanted.items()):
        if monotonic() > deadline:
            raise UserError("the nodes of this process did not find each other")
        sleep(0.005)
