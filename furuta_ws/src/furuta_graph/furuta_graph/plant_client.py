"""Client of a running plant: resets it."""

from __future__ import annotations

from functools import partial

from rclpy.node import Node
from std_srvs.srv import Trigger

from furuta_ros.services import ServiceError, WaitsForFutures, call_service
from furuta_sim.settings.nodes import PLANT


class PlantClient:
    """Calls the reset service of the plant."""

    def __init__(self, node: Node, executor: WaitsForFutures) -> None:
        self._node = node
        self._executor = executor
        self._reset = node.create_client(Trigger, f"{PLANT}/reset")

    def reset(self) -> str:
        """Put the pendulum into its initial state; returns the plant's answer.

        Estimator and friction observer start anew when its next measurement arrives.

        Raises:
            ServiceError: No plant answers, or it rejects the reset.
        """
        send = partial(self._reset.call_async, Trigger.Request())
        wait = self._reset.wait_for_service
        answer = call_service(self._executor, PLANT, wait, send, caller=self._node)
        if not answer.success:
            raise ServiceError(f"{PLANT} rejects the reset: {answer.message}")
        return str(answer.message)
