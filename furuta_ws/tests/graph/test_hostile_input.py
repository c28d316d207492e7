"""Messages, requests and parameters that nobody means: no node ends."""

from array import array
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rcl_interfaces.msg import Parameter, ParameterEvent, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters, SetParametersAtomically
from rclpy.logging import LoggingSeverity
from rosbags.highlevel import AnyReader
from sensor_msgs.msg import JointState
from testbench import Bench

from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.settings.nodes import NODES
from furuta_graph.settings.settings import Settings
from furuta_recordings.recorder_node import RecorderNode
from furuta_ros import parameter_service
from furuta_ros.topics import JOINT_STATES, Topic
from furuta_view.live_node import LiveNode

# Of each kind, on each node.
COUNT = 1000
TEXTS = ("", "\x1b[2J", "é" * 40, "x" * 3000, "..", "friction.law", "mode", "method", "sample_time")
NUMBERS = (0.0, -1.0, 77.0, float("nan"), float("inf"), -1e308, 5e-324, 0.3)


def fill(r: np.random.Generator, message: Any) -> Any:
    """The message with random content."""
    for name, kind in message.get_fields_and_field_types().items():
        setattr(message, name, content(r, getattr(message, name), kind))
    return message


def content(r: np.random.Generator, value: Any, kind: str) -> Any:
    """Random content for a field with this value, of this kind."""
    if hasattr(value, "get_fields_and_field_types"):
        return fill(r, value)
    count = r.integers(4)
    make: dict[str, Callable[[], Any]] = {
        "string": lambda: str(r.choice(TEXTS)),
        "boolean": lambda: bool(r.integers(2)),
        "double": lambda: float(r.choice(NUMBERS)),
        "sequence<rcl_interfaces/Parameter>": lambda: [parameter(r) for _ in range(count)],
        "sequence<string>": lambda: [str(r.choice(TEXTS)) for _ in range(count)],
        "sequence<double>": lambda: array("d", r.choice(NUMBERS, count)),
    }
    if kind in make:
        return make[kind]()
    return int(r.integers(128 if kind.endswith("8") else 2**31)) if value == 0 else value


NAMES: list[str] = []  # of the parameters of the node under test


def parameter(r: np.random.Generator) -> Parameter:
    """One of the node's parameters or none, of any type."""
    name = str(r.choice(NAMES)) if r.integers(4) else str(r.choice(TEXTS))
    return Parameter(name=name, value=fill(r, ParameterValue(type=int(r.choice([*range(10), 77])))))


@pytest.fixture(params=NODES)
def node(request: pytest.FixtureRequest, bench: Bench, monkeypatch: Any) -> Iterator[Any]:
    """A node of the graph on the bench."""
    made = bench.add(NODES[request.param].load_class()([]))
    made.get_logger().set_level(LoggingSeverity.FATAL)
    monkeypatch.setattr(parameter_service, "RATE", 1e6)  # each change is tried
    NAMES[:] = list(made._parameters)
    yield made
    made.get_logger().set_level(LoggingSeverity.UNSET)


def test_no_request_ends_a_node(bench: Bench, node: Any) -> None:
    """On every service; parameters of all types, also of one that there is not."""
    r = np.random.default_rng(2)
    for service in list(node.services):
        name = node.resolve_service_name(service.srv_name)
        client = bench.probe.create_client(service.srv_type, name)
        bench.spin(client.service_is_ready)
        for _ in range(COUNT // len(list(node.services)) + 1):
            future = client.call_async(fill(r, service.srv_type.Request()))
            bench.spin(future.done)
            assert future.exception() is None
    require_alive(bench, node)


def require_alive(bench: Bench, node: Any) -> None:
    """The node answers."""
    client = bench.probe.create_client(GetParameters, f"{node.get_name()}/get_parameters")
    bench.spin(client.service_is_ready)
    future = client.call_async(GetParameters.Request(names=["use_sim_time"]))
    bench.spin(future.done)
    assert len(future.result().values) == 1


def test_a_parameter_of_an_unknown_type_is_refused(bench: Bench, node: Any) -> None:
    """With a reason, by both services."""
    unknown = [Parameter(name=NAMES[0], value=ParameterValue(type=77))]
    for kind, name in ((SetParameters, ""), (SetParametersAtomically, "_atomically")):
        client = bench.probe.create_client(kind, f"{node.get_name()}/set_parameters{name}")
        bench.spin(client.service_is_ready)
        future = client.call_async(kind.Request(parameters=unknown))
        bench.spin(future.done)
        answer = future.result()
        result = answer.result if name else answer.results[0]
        assert not result.successful
        assert "77 is not a valid" in result.reason


# Events and states that cannot be read, or whose parameters have no known type.
MALFORMED = (b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + b"\xff" * 40, b"\xff" * 9)
UNKNOWN = Parameter(name="alpha0", value=ParameterValue(type=77))


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


def test_malformed_messages_do_not_end_the_page(bench: Bench) -> None:
    """Its node leaves them out."""
    received: list[ParameterEvent] = []
    node = bench.add(LiveNode(received.append))
    events = bench.publisher(Topic("/parameter_events", ParameterEvent))
    states = bench.publisher(JOINT_STATES.throttled)
    for data in MALFORMED:
        events.publish(data)
        states.publish(data)
    events.publish(ParameterEvent(node="/last"))
    bench.spin(lambda: node.collect() or any(each.node == "/last" for each in received))
