"""A client of a running graph for tuning: it reads the estimates and sets the compensation."""

from collections import deque
from collections.abc import Callable
from time import monotonic
from typing import Any

import numpy as np
from rclpy.executors import Executor
from rclpy.node import Node

from furuta.results.studies import Tuning
from furuta.settings.nodes import CONTROLLER, ESTIMATOR, FRICTION_OBSERVER, NODES
from furuta.studies.trials import Compensation
from furuta.studies.tuning import ProgressCallback, tune
from furuta.studies.tuning_plan import TuningPlan
from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_bringup.graph.services import ServiceError
from furuta_bringup.options import joined_node
from furuta_model.parameters import build, declared
from furuta_model.state import SIGNALS
from furuta_ros.errors import UserError
from furuta_ros.messages import typed_joint_state
from furuta_ros.node import deep
from furuta_ros.process import StopSignal
from furuta_ros.spinning import SPIN_TIMEOUT
from furuta_ros.topics import JOINT_STATES
from furuta_ros.wire import unpack_joint_state

# Longest wait for the next estimate [s].
TIMEOUT = 10.0
# Estimates that may wait while parameters are set: half a minute at 1 kHz.
BUFFER_SIZE = 30_000


class TuningInterruptedError(Exception):
    """The user has stopped the tuning."""


class EstimateBuffer:
    """State estimates that have arrived and are not yet read."""

    def __init__(self, node: Node) -> None:
        self.waiting: deque[bytes] = deque(maxlen=BUFFER_SIZE)
        node.create_subscription(
            JOINT_STATES.message, JOINT_STATES.name, self._receive, deep(BUFFER_SIZE), raw=True
        )

    def _receive(self, message: bytes) -> None:
        self.waiting.append(message)


class TuningClient:
    """Reads ``joint_states`` and sets estimator, observer and controller, as a user would.

    ``stop`` is called while :meth:`watch` waits; once it returns true, :meth:`watch` raises
    :class:`TuningInterruptedError`. :meth:`apply` still works then, to restore parameters.
    """

    def __init__(
        self,
        client: ParameterClient,
        estimates: EstimateBuffer,
        executor: Executor,
        stop: Callable[[], bool] = lambda: False,
    ) -> None:
        self.client = client
        self._executor = executor
        self._stop = stop
        self._waiting = estimates.waiting
        self.estimator = self._read(ESTIMATOR)
        observer, controller = self._read(FRICTION_OBSERVER).observer, self._read(CONTROLLER)
        self.compensation = Compensation(self.estimator, observer, controller)

    def apply(self, compensation: Compensation) -> None:
        """Set the parameters that differ, node by node, and drop earlier estimates."""
        every = compensation.changes(self.compensation).items()
        for (node, changes), part in zip(every, Compensation._fields, strict=True):
            if changes:
                self.client.set_all(node, changes)
                own = {part: getattr(compensation, part)}
                self.compensation = self.compensation._replace(**own)
        self._waiting.clear()

    def watch(self, seconds: float) -> np.ndarray:
        """The estimates (n, 5) of the next ``seconds`` of pendulum time."""
        samples = max(1, round(seconds / self.estimator.sample_time))
        estimates = np.empty((samples, SIGNALS))
        for row in estimates:
            data = self._next()
            _, row[:] = unpack_joint_state(data) or typed_joint_state(data)
        return estimates

    def _next(self) -> bytes:
        deadline = monotonic() + TIMEOUT
        while not self._waiting:
            if self._stop():
                raise TuningInterruptedError
            if monotonic() > deadline:
                raise ServiceError(f"no {JOINT_STATES.name} for {TIMEOUT:g} s")
            self._executor.spin_once(timeout_sec=SPIN_TIMEOUT)
        return self._waiting.popleft()

    def _read(self, node: str) -> Any:
        group = NODES[node].parameters
        names = [parameter.name for parameter in declared(group)]
        return build(group, self.client.get(node, names))


def tune_running(
    namespace: str, plan: TuningPlan, report: ProgressCallback, follow: float = 0.0
) -> Tuning:
    """Tune the graph of a namespace, which keeps the result; then watch it for ``follow`` [s].

    Raises:
        UserError: It was interrupted. The initial parameters are restored.
    """
    with joined_node("furuta_tune", namespace) as (node, executor):
        services, estimates = ParameterClient(node, executor), EstimateBuffer(node)
        client = TuningClient(services, estimates, executor, StopSignal())
        try:
            found = tune(client, client.compensation, plan, report, follow)
            return Tuning(**vars(found))
        except TuningInterruptedError:
            raise UserError("interrupted; the initial parameters are restored") from None
