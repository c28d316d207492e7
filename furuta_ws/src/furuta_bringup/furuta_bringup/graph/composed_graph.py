"""The whole graph in one process, on one executor."""

from collections.abc import Collection, Iterable
from typing import Any, ClassVar, cast

from rclpy.clock import Clock, ClockType
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.parameter import Parameter

from furuta.settings.nodes import (
    HARDWARE_BRIDGE,
    PLANT,
    NodeDescription,
    check_graph,
    graph_nodes,
)
from furuta.settings.settings import Settings
from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_recordings.recorder_node import COLLECT_EVERY, MakeRecorder
from furuta_ros.node import FurutaNode
from furuta_ros.one_graph import claim
from furuta_ros.spinning import executor_of, prepare_to_spin, spin_until, wait_until_matched
from furuta_sim.plant_node import PlantNode


class ComposedGraph:
    """The nodes of a graph, with ``others`` beside them, on one executor.

    Time starts once all nodes know each other and the bag, if there is one to ``record``, exists,
    so the bag holds the first sample. The recorder collects between samples; it ends with the
    graph. ``nodes`` holds the controlled system first.
    """

    controlled: ClassVar[str]

    def __init__(
        self,
        settings: Settings,
        others: Iterable[Node] = (),
        record: MakeRecorder | None = None,
        without: Collection[str] = (),
    ) -> None:
        described = graph_nodes(self.controlled, without)
        # The controlled system last: the real time of the plant starts when it is made.
        made = {node.name: _make(node, settings) for node in reversed(described)}
        check_graph({name: node.parameters for name, node in made.items()})
        controlled = made[self.controlled]
        self._claim = claim(controlled.context.get_domain_id(), controlled.get_namespace())
        self._by_name = made
        self.nodes: list[Node] = [*(made[node.name] for node in described), *others]
        self._recorder = record() if record is not None else None
        if self._recorder is not None:
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self.nodes[0].create_timer(COLLECT_EVERY, self._recorder.collect, clock=steady)
        wait_until_matched([*self.nodes, *([self._recorder] if self._recorder else [])])
        self.executor: Executor = executor_of(self.nodes)
        prepare_to_spin()

    def node(self, name: str) -> FurutaNode[Any]:
        """The node of that name."""
        return self._by_name[name]

    @property
    def recording_failure(self) -> str | None:
        """Why the recording ended before the graph; None if it did not."""
        return self._recorder.failure if self._recorder is not None else None

    def end_recording(self) -> None:
        """Finish the bag, if there is one."""
        if self._recorder is not None:
            self._recorder.close()

    def close(self) -> None:
        """End the recording, then the nodes."""
        self.executor.shutdown()
        if self._recorder is not None:
            self._recorder.destroy_node()
        for node in self.nodes:
            node.destroy_node()
        self._claim.close()


class SimulatedGraph(ComposedGraph):
    """The graph with the simulated plant."""

    controlled = PLANT

    @property
    def plant(self) -> PlantNode:
        """The plant's node."""
        return cast(PlantNode, self.nodes[0])

    def run_until(self, seconds: float) -> None:
        """Spin until the plant has paused at ``seconds`` (its ``run_until`` set to that)."""
        plant = self.plant
        spin_until(self.executor, lambda: plant.paused or plant.time >= seconds - 1e-9)


class HardwareGraph(ComposedGraph):
    """The graph with the bridge to a real rig."""

    controlled = HARDWARE_BRIDGE

    @property
    def bridge(self) -> HardwareBridgeNode:
        """The bridge's node."""
        return cast(HardwareBridgeNode, self.nodes[0])


def _make(description: NodeDescription, settings: Settings) -> FurutaNode[Any]:
    given = settings[description.name].items()
    overrides = [Parameter(name, value=value) for name, value in given]
    made: FurutaNode[Any] = description.load_class()(overrides)
    return made
