"""A graph in lock-step in other processes, run sample by sample so that no message is lost."""

from typing import Any

import numpy as np

from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_bringup.graph.processes import executable
from furuta_bringup.launching import launched_nodes
from furuta_ros.node import QOS
from furuta_ros.testing import Bench
from furuta_ros.topics import GROUND_TRUTH, Topic


def launch_commands(**arguments: str) -> list[list[str]]:
    """The commands that ``ros2 launch`` starts with these launch arguments."""
    return [_command(node) for node in launched_nodes(**arguments)]


def _command(node: dict[str, Any]) -> list[str]:
    path = executable(node["package"], node["executable"])
    names = "-r", f"__node:={node['name']}", "-r", f"__ns:={node['namespace'] or '/'}"
    return [str(path), "--ros-args", *node["ros_arguments"], *names]


class PausedGraph:
    """A graph in lock-step that has started with ``run_until`` 0."""

    def __init__(self, bench: Bench, namespace: str = "", sample_time: float = 0.001) -> None:
        self._bench = bench
        self._plant = f"/{namespace}/plant" if namespace else "plant"
        self._sample_time = sample_time
        name = f"/{namespace}/{GROUND_TRUTH.name}" if namespace else GROUND_TRUTH.name
        self.topic = Topic(name, GROUND_TRUTH.type)
        bench.received[name] = []
        self.truths = bench.collect(self.topic)

    def run(self, samples: int) -> np.ndarray:
        """The true states (n, 4) of the first samples, without a gap.

        The plant runs for as many samples at a time as its publisher keeps: none can be lost.
        """
        self._bench.wait_for_publisher(self.topic)
        client = ParameterClient(self._bench.probe, self._bench.executor)
        for end in range(QOS.depth, samples + 1, QOS.depth):
            client.set(self._plant, run_until=end * self._sample_time)
            self._bench.spin(lambda end=end: len(self.truths) >= end, timeout=60.0)
        stamps = [t.header.stamp.sec * 10**9 + t.header.stamp.nanosec for t in self.truths]
        assert stamps == [round(k * self._sample_time * 1e9) for k in range(samples)]
        return np.array(
            [(t.position[0], t.velocity[0], t.position[1], t.velocity[1]) for t in self.truths]
        )
