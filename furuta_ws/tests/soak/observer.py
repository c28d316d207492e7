"""A node that observes a graph in other processes: true states, measurements, services."""

from collections.abc import Callable
from time import monotonic
from typing import Any

import numpy as np
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from furuta_ros.spinning import executor_of
from furuta_ros.topics import GROUND_TRUTH, MEASUREMENT, Topic, deep

# Messages of a topic that may wait.
DEPTH = 10_000
# Time to wait for the answer of a service [s].
ANSWER = 60.0


class Observer:
    """Collects the plant's messages, and calls services of the graph."""

    def __init__(self) -> None:
        self.node = Node("soak")
        self._executor = executor_of([self.node])
        self.truths = self._collect(GROUND_TRUTH)
        self.measurements = self._collect(MEASUREMENT)
        self._clients: dict[str, Any] = {}
        self.requests = 0  # sent to services

    def _collect(self, topic: Topic) -> list[Any]:
        received: list[Any] = []
        self.node.create_subscription(topic.type, topic.name, received.append, deep(DEPTH))
        return received

    def spin(self, until: Callable[[], bool], seconds: float) -> bool:
        """Spin until the condition holds; returns whether it does in time."""
        deadline = monotonic() + seconds
        while not until():
            if monotonic() > deadline:
                return False
            self._executor.spin_once(timeout_sec=0.02)
        return True

    def spin_for(self, seconds: float) -> None:
        """Collect messages for some time."""
        self.spin(lambda: False, seconds)

    def set(self, node: str, *parameters: Parameter) -> Any:
        """The result of setting parameters; None without an answer."""
        request = SetParametersAtomically.Request()
        request.parameters = [each.to_parameter_msg() for each in parameters]
        return self.call(SetParametersAtomically, f"{node}/set_parameters_atomically", request)

    def reset(self) -> bool:
        """Put the plant upright again; returns whether it answered."""
        return self.call(Trigger, "plant/reset", Trigger.Request()) is not None

    def call(self, kind: Any, service: str, request: Any) -> Any:
        """The response of a service, asked until it answers; None if it does not."""
        client = self._clients.get(service)
        if client is None:
            client = self._clients[service] = self.node.create_client(kind, service)
        deadline = monotonic() + ANSWER
        while monotonic() < deadline:
            if self.spin(client.service_is_ready, 1.0):
                self.requests += 1
                future = client.call_async(request)
                if self.spin(future.done, 3.0):
                    return future.result()
                client.remove_pending_request(future)
        return None

    def clear(self) -> None:
        """Forget the messages so far."""
        self.truths.clear()
        self.measurements.clear()

    def close(self) -> None:
        """End the node."""
        self._executor.shutdown()
        self.node.destroy_node()


def states(messages: list[Any]) -> np.ndarray:
    """True states (n, 4) of messages."""
    rows = [(m.position[0], m.velocity[0], m.position[1], m.velocity[1]) for m in messages]
    return np.array(rows).reshape(-1, 4)


def stamps(messages: list[Any]) -> np.ndarray:
    """Time stamps (n,) of messages [ns]."""
    values = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in messages]
    return np.array(values, dtype=np.int64)


def motion(observer: Observer) -> np.ndarray:
    """True pendulum angle [rad] and torque [V] (n, 2) of the samples received on both topics."""
    sent = [m for m in observer.measurements if len(m.effort) == 2]  # not those of an intruder
    torque = {stamp: m.effort[0] for stamp, m in zip(stamps(sent), sent, strict=True)}
    truths = list(observer.truths)
    rows = zip(stamps(truths), truths, strict=True)
    common = ((stamp, t) for stamp, t in rows if stamp in torque)
    kept = [(t.position[1], torque[stamp]) for stamp, t in common]
    return np.array(kept).reshape(-1, 2)
