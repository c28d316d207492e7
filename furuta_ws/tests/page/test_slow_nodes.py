"""A node that hangs holds up neither the other nodes on the page nor the arming of a rig."""

import threading
from collections.abc import Iterator
from contextlib import ExitStack
from time import monotonic, sleep
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.node import Node
from std_srvs.srv import SetBool

from furuta.settings.nodes import HARDWARE_BRIDGE
from furuta_bringup.graph.services import ServiceError
from furuta_bringup.page.graph_link import GraphLink
from furuta_bringup.page.page_layout import Layout
from furuta_bringup.page.parameter_panel import Described
from furuta_bringup.page.parameters_on_page import ParametersOnPage
from furuta_bringup.page.server import PageServer
from furuta_ros.spinning import SpinningThread

TIMEOUT = 120.0


class HangingNode:
    """A graph in which the node ``controller`` does not answer until ``answers`` is set."""

    def __init__(self) -> None:
        self.answers = False

    def nodes(self) -> list[str]:
        """The nodes that run."""
        return ["controller", "estimator", HARDWARE_BRIDGE]

    def described(self, node: str) -> list[Described]:
        """The parameters of a node."""
        if node == "controller" and not self.answers:
            raise ServiceError("controller did not answer within 20 s")
        return [Described("sample_time", 0.001)]


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = PageServer()
    yield server
    server.stop()


def test_other_nodes_are_shown(server: PageServer) -> None:
    """And the hanging one as soon as it answers."""
    link: Any = HangingNode()
    layout = Layout(server)
    page = ParametersOnPage(server.gui, link, layout.main, layout.parameters)
    page.find_nodes()
    assert page.running == link.nodes()
    assert page.silent == ["controller"]
    assert set(page.values) == {"estimator", HARDWARE_BRIDGE}
    link.answers = True
    page.find_nodes()
    assert set(page.values) == set(link.nodes())


@pytest.fixture
def link(ros: None) -> Iterator[GraphLink]:
    link = GraphLink()
    yield link
    link.close()


def test_a_node_is_found_beside_others_of_its_name(link: GraphLink) -> None:
    """Also if the others, of which one came before it and one after it, have no parameters.

    Each has a context of its own, as nodes in processes of their own do.
    """
    with ExitStack() as opened:
        for has_parameters in (False, True, False):
            context = opened.enter_context(Context())
            node = Node("twin", context=context, start_parameter_services=has_parameters)
            opened.callback(node.destroy_node)
        end = monotonic() + TIMEOUT
        while link.nodes() != ["twin"]:
            assert monotonic() < end, "never found"
            sleep(0.05)


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


def test_work_that_fails_does_not_end_the_thread(link: GraphLink) -> None:
    """Nor does a control that has gone when its value is refused."""
    reasons: list[str] = []
    done = threading.Event()

    def fail() -> None:
        raise ServiceError("rejected")

    def refuse(reason: str) -> None:
        reasons.append(reason)
        raise KeyError("the control has gone")

    link.requests.submit("first", fail, refuse)
    link.requests.submit("second", done.set)
    assert done.wait(TIMEOUT)
    assert reasons == ["rejected"]
