"""Nodes that hang or are silent: what the page says, and what it does meanwhile."""

import asyncio
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool

from furuta.settings.nodes import HARDWARE_BRIDGE
from furuta_bringup.page.graph_link import GraphLink, SpinningThread
from furuta_bringup.page.live_page import LivePage
from furuta_bringup.page.server import PageServer
from furuta_ros.middleware import ros_domain
from furuta_sim.plant_node import PlantNode

TIMEOUT = 120.0


@pytest.fixture
def link(ros: None) -> Iterator[GraphLink]:
    link = GraphLink()
    yield link
    link.close()


def test_disarming_does_not_wait(link: GraphLink) -> None:
    """While a search and a request hang, the bridge is disarmed."""
    hangs, called = threading.Event(), threading.Event()
    requests: list[bool] = []

    def on_arm(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        requests.append(request.data)
        called.set()
        response.success = True
        return response

    bridge = Node(HARDWARE_BRIDGE)
    bridge.create_service(SetBool, "~/arm", on_arm)
    spinning = SpinningThread([bridge])
    for jobs in (link.search, link.requests, link.computation):
        jobs.submit("hangs", lambda: bool(hangs.wait()))
    link.arming.submit("arm", link.bridge.disarm)
    assert called.wait(TIMEOUT)
    assert not any(requests)
    hangs.set()
    spinning.close(TIMEOUT)
    bridge.destroy_node()


def test_empty_start_says_what_is_awaited(ros: None) -> None:
    """And how to begin it; a node that was found, but sends nothing, is named."""
    server, silent = PageServer(), Node(HARDWARE_BRIDGE)
    page, spinning = LivePage(server), SpinningThread([silent])
    seen: list[dict[str, Any]] = []

    def told() -> bool:
        seen.append(server.known.get("status", {}))
        return any("found, but silent" in each for each in seen[-1].get("notices", []))

    asyncio.run(page.run(told))
    waits = next(status["waiting"] for status in seen if "waiting" in status)
    assert "furuta run" in waits["command"]
    assert f"ROS domain {ros_domain()}" in waits["place"]
    assert HARDWARE_BRIDGE in seen[-1]["notices"][-1]
    page.close()
    spinning.close(TIMEOUT)
    silent.destroy_node()


def test_a_closed_page_withdraws_its_push(ros: None) -> None:
    """The pushes that the plant had before are in its parameters again."""
    had = {"clock": "lockstep", "pushes.times": [5.0], "pushes.arm": [1.0]}
    plant = PlantNode([Parameter(name, value=value) for name, value in had.items()])
    page, spinning = LivePage(PageServer()), SpinningThread([plant])
    before = plant.parameters.plant.pushes
    page._link.push("pushes.arm", 2.0)
    assert plant.parameters.plant.pushes.arm == (2.0,)
    page.close()
    assert plant.parameters.plant.pushes == before
    spinning.close(TIMEOUT)
    plant.destroy_node()


NUMBERS = (0, -1, 1e308, -1e308, 2**70, float("nan"), float("inf"), True, None)
PARTS = (
    *NUMBERS,
    "",
    "plant.alpha0",
    "pushes.arm",
    "scene",
    [],
    {},
    [[0.0]],
    {"scene": 0},
    "x" * 99,
)
KEYS = ("set", "push", "size", "reset", "put", "speed", "step", "place", "", "rows", "values")


def test_what_a_page_sends_by_mistake_sets_nothing(ros: None) -> None:
    """Random messages, most of them nearly right: each is left out, or refused with a reason."""
    random, server = np.random.default_rng(1), PageServer()
    page = LivePage(server)

    def part(depth: int = 2) -> Any:
        kind = random.integers(0, 4) if depth else 3
        if kind == 0:
            return {KEYS[random.integers(len(KEYS))]: part(depth - 1) for _ in range(3)}
        if kind == 1:
            return [part(depth - 1) for _ in range(random.integers(4))]
        return PARTS[random.integers(len(PARTS))]

    for _ in range(2000):
        server.received({KEYS[random.integers(len(KEYS))]: part() for _ in range(4)})
    assert server.known.get("place") is None
    asyncio.run(page.run(iter([False, True]).__next__))
    page.close()
    assert not page._failures
