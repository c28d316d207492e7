"""Nodes that hang or are silent: what the page says, and what it does meanwhile."""

import threading
from collections.abc import Iterator

import pytest
from rclpy.node import Node
from std_srvs.srv import SetBool

from furuta.settings.nodes import HARDWARE_BRIDGE
from furuta_bringup.page.graph_link import GraphLink, SpinningThread
from furuta_bringup.page.live_page import LivePage
from furuta_bringup.page.server import PageServer

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
    seen: list[str] = []

    def told() -> bool:
        seen.append(page.status)
        return HARDWARE_BRIDGE in page.status

    page.run(told)
    assert "Waiting for a running graph" in seen[0]
    assert "furuta run" in seen[0]
    assert "found, but silent" in seen[-1]
    page.close()
    server.stop()
    spinning.close(TIMEOUT)
    silent.destroy_node()
