"""Every node: all its topics and odd messages on them, its status, parameters saved and loaded."""

from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from counting import count_handled
from diagnostic_msgs.msg import DiagnosticStatus
from lifecycle_msgs.srv import GetState
from odd_messages import MALFORMED, good, is_sent, odd
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from std_srvs.srv import SetBool

from furuta.settings.nodes import HARDWARE_BRIDGE, NODES
from furuta_bringup.graph.services import ServiceError
from furuta_bringup.graph.system_client import BridgeClient
from furuta_bringup.page.live_node import LiveNode
from furuta_bringup.page.live_page import LivePage
from furuta_ros.node import LATCHED, FurutaNode
from furuta_ros.testing import Bench
from furuta_ros.topics import DIAGNOSTICS

# Parameters with which a node works alone; a joint's observer is one of its own kind.
GIVEN = {
    **{name: (name, {}) for name in NODES},
    "plant in lock-step": ("plant", {"clock": "lockstep"}),
    HARDWARE_BRIDGE: (HARDWARE_BRIDGE, {"port": "mock", "autostart": "active"}),
    "joint": ("friction_observer", {"joint": "pendulum", "axis.inertia": 0.1}),
}
DOCUMENTED = (Path(__file__).resolve().parents[3] / "docs" / "topics.md").read_text("utf-8")
OF_ROS = {"/rosout", "/parameter_events"}
# Keeps all messages of a test, for subscribers of either durability.
ALL = QoSProfile(depth=1000, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture(params=GIVEN)
def node(request: pytest.FixtureRequest, bench: Bench) -> FurutaNode[Any]:
    """Each node, alone on the bench."""
    name, given = GIVEN[request.param]
    parameters = [Parameter(key, value=value) for key, value in given.items()]
    made: FurutaNode[Any] = bench.add(NODES[name].load_class()(parameters))
    made.start_up()
    return made


def test_no_message_surprises_a_node(
    bench: Bench, node: FurutaNode[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It answers or refuses each message on each of its topics; no callback fails."""
    failures: list[str] = []
    monkeypatch.setattr(
        FurutaNode, "report_failure", lambda self, *of: failures.append(str(of)) or ""
    )
    handled = count_handled(node)
    inputs = {each.topic_name: each.msg_type for each in node.subscriptions}
    for topic, kind in inputs.items():
        publisher = bench.probe.create_publisher(kind, topic, ALL)
        bench.spin(lambda publisher=publisher: publisher.get_subscription_count() > 0)
        for data in MALFORMED:  # of some of them ROS itself calls no callback
            is_sent(publisher, data)
        bench.settle(0.02)
        for message in (*odd(kind), good(kind)):
            before = handled[topic.strip("/")]
            publisher.publish(message)
            bench.spin(lambda topic=topic, n=before: handled[topic.strip("/")] > n)
    assert not failures


def test_topics(bench: Bench, node: FurutaNode[Any]) -> None:
    """A late subscriber gets one message, the last; all topics are documented; it has a status."""
    statuses = bench.collect(DIAGNOSTICS)
    bench.wait_for_publisher(DIAGNOSTICS)
    for end in (*node.publishers, *node.subscriptions):
        qos, topic = end.qos_profile, end.topic_name
        if topic in OF_ROS or topic.endswith("transition_event"):
            continue
        if qos.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL:
            assert qos.depth == LATCHED.depth == 1
        name = topic.removesuffix("_throttle").removeprefix(node.get_namespace())
        assert f"`{name}`" in DOCUMENTED or f"`{topic}`" in DOCUMENTED
    node.publish_status()
    bench.spin(lambda: len(statuses) > 0)
    (status,) = statuses[-1].status
    assert status.name == node.get_fully_qualified_name()
    assert node.get_name() == HARDWARE_BRIDGE or (status.level, status.message) == (
        b"\0",
        "running",
    )


def test_what_is_saved_can_be_loaded(bench: Bench, node: FurutaNode[Any]) -> None:
    """All values, as ``ros2 param load`` sends them; with a wrong one only that is refused."""
    saved = [each.to_parameter_msg() for each in node._parameters.values()]
    fixed = Parameter("own_parts", value="other").to_parameter_msg()

    def reasons(kind: Any, service: str, *more: Any) -> list[str]:
        client = bench.probe.create_client(kind, f"{node.get_name()}/{service}")
        bench.spin(client.service_is_ready)
        future = client.call_async(kind.Request(parameters=[*saved, *more]))
        bench.spin(future.done)
        results = getattr(future.result(), "results", None) or [future.result().result]
        return [each.reason for each in results if not each.successful]

    assert reasons(SetParametersAtomically, "set_parameters_atomically") == []
    assert reasons(SetParameters, "set_parameters") == []
    saved = [each for each in saved if each.name != fixed.name]
    (reason,) = reasons(SetParameters, "set_parameters", fixed)
    assert "own_parts" in reason or "read-only" in reason


def test_only_the_bridge_of_this_graph_counts(bench: Bench) -> None:
    """Of those in other namespaces, which publish on the same topic, nothing is said."""
    others = ("/b/hardware_bridge", "/hardware_bridge/b", "hardware_bridge", "hardware_bridge: rig")
    view = LiveNode(lambda event: None, lambda *of: None)
    publisher = bench.probe.create_publisher(DIAGNOSTICS.message, DIAGNOSTICS.name, ALL)
    bench.probe.create_service(GetState, "hardware_bridge/get_state", lambda _, answer: answer)
    client = BridgeClient(bench.probe, bench.executor)

    def publish(*names: str) -> None:
        status = [DiagnosticStatus(level=b"\2", name=name, message=name) for name in names]
        publisher.publish(DIAGNOSTICS.message(status=status))

    def arm(request: SetBool.Request, answer: SetBool.Response) -> SetBool.Response:
        bench.probe.create_timer(0.1, lambda: publish(*others, *extra))
        answer.success = True
        return answer

    bench.probe.create_service(SetBool, "hardware_bridge/arm", arm)
    extra: list[str] = []
    client.arm_and_watch()
    bench.spin(lambda: publisher.get_subscription_count() > 0)
    view.collect()
    assert view.status is None and not view.warnings
    extra = ["/hardware_bridge"]
    with pytest.raises(ServiceError, match=r"stopped at once: /hardware_bridge$"):
        client.arm_and_watch()
    view.collect()
    assert view.status.name == "/hardware_bridge"
    view.destroy_node()


def test_no_message_ends_the_page(bench: Bench) -> None:
    """Nor is there an exception that its guard has to catch."""
    nothing = partial(lambda *_, **__: None)
    page = LivePage(SimpleNamespace(known={}, tell=nothing, say=nothing, send=nothing))  # type: ignore[arg-type]
    inputs = {each.topic_name: each.msg_type for each in page._node.subscriptions}
    for topic, kind in inputs.items():
        publisher = bench.probe.create_publisher(kind, topic, ALL)
        bench.spin(lambda publisher=publisher: publisher.get_subscription_count() > 0)
        for message in (*odd(kind), *MALFORMED):
            is_sent(publisher, message)
            bench.executor.spin_once(timeout_sec=0.002)
            page._time, page._nodes.running = 1.0, list(NODES)
            page._guard(partial(page._do, 0))
    page._link.close()
    page._node.destroy_node()
    assert not page._failures
