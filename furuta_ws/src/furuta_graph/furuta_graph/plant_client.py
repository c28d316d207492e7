"""Client of a running plant: resets it."""

from __future__ import annotations

from functools import partial

from rclpy.node import Node
from std_srvs.srv import Trigger

from furuta_graph.description import PLANT
from furuta_ros.services import ServiceError, call_service
from furuta_ros.spinning import executor_of


def reset_plant() -> str:
    """Call the reset service of the plant; returns what it answers.

    Estimator and friction observer start anew when its next measurement arrives.

    Raises:
        ServiceError: No plant answers, or it rejects the reset.
    """
    node = Node("furuta_reset")
    client = node.create_client(Trigger, f"{PLANT}/reset")
    send = partial(client.call_async, Trigger.Request())
    answer = call_service(executor_of([node]), PLANT, client.wait_for_service, send, caller=node)
    if not answer.success:
        raise ServiceError(f"{PLANT} rejects the reset: {answer.message}")
    return str(answer.message)
