"""A running graph as a rig to be tuned: estimates by topic, parameters by their services."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from time import monotonic
from typing import NamedTuple, TypeVar

import numpy as np
from rclpy.executors import Executor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_graph.parameter_client import ParameterClient, ServiceError
from furuta_model.parameters import build, declared, values
from furuta_model.state import SIGNALS
from furuta_ros.messages import read_joints
from furuta_ros.spinning import TURN
from furuta_ros.topics import JOINT_STATES, deep

Group = TypeVar("Group", bound=NamedTuple)

# Longest wait for the next estimate [s].
TIMEOUT = 10.0
# Estimates that may pile up while parameters are set: half a minute at 1 kHz.
BACKLOG = 30_000


class TuningInterruptedError(Exception):
    """The user wants it to end."""


class Estimates:
    """The state estimates that came and were not yet looked at."""

    def __init__(self, node: Node) -> None:
        self.waiting: deque[JointState] = deque(maxlen=BACKLOG)
        node.create_subscription(JOINT_STATES.type, JOINT_STATES.name, self._take, deep(BACKLOG))

    def _take(self, message: JointState) -> None:
        self.waiting.append(message)


class RunningLoop:
    """Watches ``joint_states`` and sets the friction observer as ``ros2 param`` would.

    ``stop`` is asked at every turn; once it is true, :meth:`watch` raises
    :class:`TuningInterruptedError`, but :meth:`apply` still puts parameters back.
    """

    def __init__(
        self,
        client: ParameterClient,
        estimates: Estimates,
        executor: Executor,
        stop: Callable[[], bool] = lambda: False,
    ) -> None:
        self.client = client
        self._executor = executor
        self._stop = stop
        self._waiting = estimates.waiting
        self.estimator = self._read("estimator", EstimatorParameters)
        self.observer = self._read("friction_observer", ObserverParameters)
        self._applied = values(self.observer)

    def apply(self, observer: ObserverParameters) -> None:
        """Set what differs from what is set, all or none; what was estimated before is dropped."""
        wanted = values(observer)
        changes = {name: each for name, each in wanted.items() if each != self._applied[name]}
        if changes:
            self.client.set_all("friction_observer", changes)
            self._applied = wanted
        self._waiting.clear()

    def watch(self, seconds: float) -> np.ndarray:
        """The estimates (n, 5) of the next ``seconds`` of pendulum time."""
        samples = max(1, round(seconds / self.estimator.sample_time))
        estimates = np.empty((samples, SIGNALS))
        for row in estimates:
            read_joints(self._next(), row)
        return estimates

    def _next(self) -> JointState:
        deadline = monotonic() + TIMEOUT
        while not self._waiting:
            if self._stop():
                raise TuningInterruptedError
            if monotonic() > deadline:
                raise ServiceError(f"no {JOINT_STATES.name} for {TIMEOUT:g} s")
            self._executor.spin_once(timeout_sec=TURN)
        return self._waiting.popleft()

    def _read(self, node: str, group: type[Group]) -> Group:
        names = [each.name for each in declared(group)]
        return build(group, self.client.get(node, names))
