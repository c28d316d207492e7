"""Calls the services of a running graph: parameters, reset, arming.

A node that hangs holds up the calls behind it. So the search for nodes, what the user asks for,
arming and the pace have a thread each: *Disarm* never waits for another node.
"""

import threading
from collections.abc import Iterable, Mapping
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.task import Future

from furuta.settings.nodes import PLANT
from furuta.settings.parameter_names import by_node
from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_bringup.graph.services import ServiceCaller
from furuta_bringup.graph.system_client import BridgeClient, put_plant, reset_plant
from furuta_bringup.page.described import Described
from furuta_bringup.page.jobs import Jobs
from furuta_ros.parameter_files import is_of_ros
from furuta_ros.spinning import executor_of, spin_until

# A push that begins at once and lasts 0.1 s of the plant's time.
PUSH = {"pushes.times": [0.0], "pushes.durations": [0.1]}
NO_PUSH = {"pushes." + of: [0.0] for of in ("arm", "pendulum", "base_x", "base_y")}
# Longest wait for the end of a call when the view ends [s].
END_TIMEOUT = 1.0


class SpinningThread:
    """Spins ``nodes`` until :meth:`close`, so that several threads can wait for responses."""

    def __init__(self, nodes: Iterable[Node]) -> None:
        self._executor = executor_of(nodes)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Wait until ``future`` is done or the time is up, in any other thread."""
        done = threading.Event()
        future.add_done_callback(lambda _: done.set())
        done.wait(timeout_sec)

    def close(self, timeout: float) -> None:
        """Stop spinning, and wait up to ``timeout`` [s] for the thread."""
        self._ended.set()
        self._executor.wake()
        self._thread.join(timeout)

    def _run(self) -> None:
        spin_until(self._executor, self._ended.is_set)


class GraphLink:
    """Requests to the nodes of the graph; each method but :meth:`nodes` is called in a job.

    ``parameters`` reads and sets those of any node, ``bridge`` arms and disarms.

    Jobs: ``search`` describes nodes, ``requests`` does what the user asks for, ``arming`` arms and
    disarms, ``pacing`` sets how far the plant runs, and ``computation`` calls no node.
    """

    def __init__(self) -> None:
        self._node = Node("view_requests", start_parameter_services=False)
        self._executor = SpinningThread([self._node])
        self.parameters = ParameterClient(self._node, self._executor)
        self.bridge = BridgeClient(self._node, self._executor)
        self._services = ServiceCaller(self._node, self._executor)
        self._pushes: dict[str, Any] = {}  # of the plant, before it was pushed
        self._jobs = [Jobs() for _ in range(5)]
        self.search, self.requests, self.arming, self.pacing, self.computation = self._jobs

    def close(self) -> None:
        """End the threads."""
        for jobs in self._jobs:
            jobs.close(END_TIMEOUT)
        self._executor.close(END_TIMEOUT)

    def nodes(self) -> list[str]:
        """Names of the nodes in this namespace that have parameter services."""
        # By the services: ROS forgets the names of a process that was held up for some seconds.
        start, end = f"{self._node.get_namespace().rstrip('/')}/", "/list_parameters"
        names = {
            service.removeprefix(start).removesuffix(end)
            for service, _ in self._node.get_service_names_and_types()
            if service.startswith(start) and service.endswith(end)
        }
        return sorted(name for name in names if not name.startswith("_") and "/" not in name)

    def described(self, node: str) -> list[Described]:
        """All parameters of a node, as its services describe them."""
        names = [name for name in self.parameters.names(node) if not is_of_ros(name)]
        if not names:
            return []
        values = self.parameters.get(node, names)
        descriptors = self.parameters.describe(node, names)
        if not descriptors:
            return [Described(name, values[name], node=node) for name in names]
        return [
            _described(name, values[name], about)._replace(node=node)
            for name, about in zip(names, descriptors, strict=True)
        ]

    def set_values(self, values: Mapping[str, Any], last_first: bool = False) -> None:
        """Set parameters by full name, node by node in the order of their names."""
        for node, own in sorted(by_node(values).items(), reverse=last_first):
            self.parameters.set_all(node, own)

    def reset(self) -> None:
        """Put the simulated pendulum into its initial state. Raises ServiceError if refused."""
        self.end_push()
        reset_plant(self._services)

    def put(self, phi: float, theta: float) -> None:
        """Let the simulated pendulum begin anew at rest with these angles [rad]."""
        self.end_push()
        put_plant(self._services, phi, theta)

    def push(self, parameter: str, size: float) -> None:
        """Push the plant now, by its parameters, which :meth:`end_push` restores."""
        push = PUSH | NO_PUSH | {parameter: [size]}
        if not self._pushes:
            before = self.parameters.get(PLANT, list(push))
            self._pushes = {name: list(value) for name, value in before.items()}
        self.parameters.set_all(PLANT, NO_PUSH)  # only what changes begins anew
        self.parameters.set_all(PLANT, push)

    def end_push(self) -> None:
        """Restore the parameters that a push has set."""
        before, self._pushes = self._pushes, {}
        if before:
            self.parameters.set_all(PLANT, before)


def _described(name: str, value: Any, descriptor: ParameterDescriptor) -> Described:
    ranges = [*descriptor.floating_point_range, *descriptor.integer_range]
    bounds = {"low": ranges[0].from_value, "high": ranges[0].to_value} if ranges else {}
    return Described(
        name,
        value,
        descriptor.description,
        descriptor.additional_constraints,
        read_only=descriptor.read_only,
        **bounds,
    )
