"""Every node: all its topics and odd messages on them, its status, parameters saved and loaded."""

import re
from array import array
from collections.abc import Iterator
from functools import partial
from importlib import import_module
from math import inf, nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from counting import count_handled
from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterEvent, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from rosbags.highlevel import AnyReader
from sensor_msgs.msg import JointState

from furuta.settings.nodes import HARDWARE_BRIDGE, NODES
from furuta.settings.settings import Settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_bringup.graph.services import ServiceError
from furuta_bringup.graph.system_client import BridgeClient
from furuta_bringup.page.live_node import LiveNode
from furuta_bringup.page.live_page import LivePage
from furuta_recordings.recorder_node import RecorderNode
from furuta_ros.node import LATCHED, FurutaNode
from furuta_ros.testing import Bench, joint_state
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
SET = SetParameters, "set_parameters"
TOGETHER = SetParametersAtomically, "set_parameters_atomically"
# Keeps all messages of a test, for subscribers of either durability.
ALL = QoSProfile(depth=1000, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)

# Bytes that are no message.
MALFORMED = (b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + b"\xff" * 40, b"\xff" * 9)
ODD: dict[str, list[Any]] = {
    "double": [nan, inf, -inf, 1e300, -1e300],
    "float": [nan, inf],
    "boolean": [True, False],
    "string": ["", "x" * 10_000, "☃", "x: rig", "/", "/hardware_bridge", "/plant"],
    "sequence<double>": [[], [nan], [inf, inf], [1e300] * 3, [0.0] * 3000],
    "sequence<string>": [[], ["arm"], ["pendulum", "arm"], ["arm", "arm"], ["x"] * 99],
    "sequence<uint64>": [[], [1], [1, 2], [2**64 - 1] * 99],
    "sequence<uint8>": [[], [255] * 9],
    "octet": [b"\xff"],
}


def is_sent(publisher: Publisher, message: Any) -> bool:
    """Publish a message; the middleware refuses bytes that are too many for their type."""
    try:
        publisher.publish(message)
    except RuntimeError:
        return False
    return True


def inputs(bench: Bench, node: Any) -> Iterator[tuple[Any, Publisher]]:
    """The type of each topic that a node hears, and a publisher that it knows."""
    for topic, kind in {each.topic_name: each.msg_type for each in node.subscriptions}.items():
        publisher = bench.probe.create_publisher(kind, topic, ALL)
        bench.spin(lambda publisher=publisher: publisher.get_subscription_count() > 0)
        yield kind, publisher


def good(kind: Any) -> Any:
    """A message that a node answers, or an empty one."""
    if kind.__name__ == "JointState":
        return joint_state((0.01, 0.0, 0.01, 0.0), 10**9)
    return kind()


def odd(kind: Any) -> Iterator[Any]:
    """Messages that differ from a good one in one field."""
    for field, named in kind.get_fields_and_field_types().items():
        for value in _values(named, getattr(good(kind), field)):
            message = good(kind)
            try:
                setattr(message, field, value)
            except (AssertionError, OverflowError):  # no such message can be sent
                continue
            yield message


def _values(named: str, default: Any) -> list[Any]:
    if named in ODD:
        is_array = isinstance(default, array)
        return [array(default.typecode, each) if is_array else each for each in ODD[named]]
    if whole := re.fullmatch(r"(u?)int(\d+)", named):
        bits = int(whole[2]) - (not whole[1])
        return [0, 2**bits - 1, *([] if whole[1] else [-(2**bits)])]
    if element := re.fullmatch(r"sequence<(\w+)/(\w+)>", named):
        kind = getattr(import_module(f"{element[1]}.msg"), element[2])
        return [[], [kind()], *([each] for each in odd(kind)), [kind()] * 50]
    return list(odd(type(default))) if "/" in named else []


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
    failures: list[Any] = []
    monkeypatch.setattr(FurutaNode, "report_failure", lambda self, *of: failures.append(of))
    handled = count_handled(node)
    for kind, publisher in inputs(bench, node):
        for data in MALFORMED:  # of some of them ROS itself calls no callback
            is_sent(publisher, data)
        bench.settle(0.02)
        topic = publisher.topic_name.strip("/")
        for message in (*odd(kind), good(kind)):
            before = handled[topic]
            publisher.publish(message)
            bench.spin(lambda topic=topic, n=before: handled[topic] > n)
    assert not failures


def test_topics(bench: Bench, node: FurutaNode[Any]) -> None:
    """A late subscriber gets one message, the last; all topics are documented; it has a status."""
    for end in (*node.publishers, *node.subscriptions):
        qos, topic = end.qos_profile, end.topic_name
        if topic in OF_ROS or topic.endswith("transition_event"):
            continue
        if qos.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL:
            assert qos.depth == LATCHED.depth == 1
        name = topic.removesuffix("_throttle").removeprefix(node.get_namespace())
        assert f"`{name}`" in DOCUMENTED or f"`{topic}`" in DOCUMENTED
    statuses = bench.collect(DIAGNOSTICS)
    bench.spin(lambda: len(statuses) > 0)
    (status,) = statuses[0].status
    assert status.name == f"/{node.get_name()}"
    assert status.message in ("running", "not armed yet", "no line")


def test_what_is_saved_can_be_loaded(bench: Bench, node: FurutaNode[Any]) -> None:
    """All values, as ``ros2 param load`` sends them; beside a wrong one only that is refused."""
    saved = [each.to_parameter_msg() for each in node._parameters.values()]
    # A type that ROS does not know, which would end the service of rclpy.
    wrong = ParameterMessage(name=saved[0].name, value=ParameterValue(type=77))
    unknown = Parameter("psi", value=1.0).to_parameter_msg()

    def refusals(kind: Any, service: str, *given: Any) -> list[str]:
        client = bench.probe.create_client(kind, f"{node.get_name()}/{service}")
        bench.spin(client.service_is_ready)
        refused = ["try again"]
        while any("try again" in each for each in refused):  # more requests than a second permits
            future = client.call_async(kind.Request(parameters=given))
            bench.spin(future.done)
            results = getattr(future.result(), "results", None) or [future.result().result]
            refused = [each.reason for each in results if not each.successful]
        return refused

    for service in (SET, TOGETHER):
        assert refusals(*service, *saved) == []
        (reason,) = refusals(*service, *saved[1:], wrong)
        assert "77 is not a valid" in reason
        (reason,) = refusals(*service, *saved[1:], unknown)
        assert reason == "undeclared parameter: psi"


def test_only_the_bridge_of_this_graph_counts(bench: Bench) -> None:
    """That one in another namespace has stopped is not said of this one."""
    names = ["/b/hardware_bridge", "/hardware_bridge/b", "hardware_bridge", "hardware_bridge: rig"]
    view = LiveNode(lambda event: None, lambda *of: None)
    publisher = bench.probe.create_publisher(DIAGNOSTICS.message, DIAGNOSTICS.name, ALL)

    def publish() -> None:
        status = [DiagnosticStatus(level=b"\2", name=name, message=name) for name in names]
        publisher.publish(DIAGNOSTICS.message(status=status))

    client = BridgeClient(bench.probe, bench.executor)
    client.arm = lambda: bench.probe.create_timer(0.1, publish)
    client.arm_and_watch()
    view.collect()
    assert (view.status, view.warnings) == (None, {})
    names.append("/hardware_bridge")
    with pytest.raises(ServiceError, match=r"stopped at once: /hardware_bridge$"):
        client.arm_and_watch()
    bench.spin(lambda: view.collect() or view.status is not None)
    assert view.status.name == "/hardware_bridge"
    view.destroy_node()


def test_no_message_ends_the_page(bench: Bench) -> None:
    """Nor is there an exception that its guard has to catch."""
    nothing = partial(lambda *_, **__: None)
    page = LivePage(SimpleNamespace(known={}, tell=nothing, say=nothing, send=nothing))  # type: ignore[arg-type]
    for kind, publisher in inputs(bench, page._node):
        for message in (*odd(kind), *MALFORMED):
            is_sent(publisher, message)
            bench.executor.spin_once(timeout_sec=0.002)
            page._time, page._nodes.running = 1.0, list(NODES)
            page._guard(partial(page._do, 0))
    page._link.close()
    page._node.destroy_node()
    assert not page._failures


# Has no known type.
UNKNOWN = ParameterMessage(name="alpha0", value=ParameterValue(type=77))


def test_malformed_messages_do_not_end_a_recording(
    bench: Bench, settings: Settings, tmp_path: Path
) -> None:
    """The bag keeps them, and what comes after them."""
    settings["plant"] |= {"clock": "lockstep", "run_until": 1.0}
    graph = SimulatedGraph(settings, record=partial(RecorderNode, tmp_path / "bag", stamped=True))
    events = bench.probe.create_publisher(ParameterEvent, "/parameter_events", 10)
    states = bench.probe.create_publisher(JointState, "ground_truth", 10)
    bench.spin(lambda: events.get_subscription_count() > 0 and states.get_subscription_count() > 0)
    for data in MALFORMED:
        events.publish(data)
        states.publish(data)
    events.publish(ParameterEvent(node="/plant", changed_parameters=[UNKNOWN]))
    graph.run_until(1.0)
    assert graph.recording_failure is None
    graph.close()
    with AnyReader([tmp_path / "bag"]) as reader:
        counts = {each.topic: each.msgcount for each in reader.connections}
    assert counts["/command"] == 1000
    assert counts["/parameter_events"] > 1
