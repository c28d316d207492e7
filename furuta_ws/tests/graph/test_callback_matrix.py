"""Every callback, task and transition fails once: the node lives on, or the rig stands at 0 V."""

import inspect
from collections.abc import Callable, Iterator
from time import monotonic
from typing import Any

import pytest
from lifecycle_msgs.msg import Transition
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter

from furuta.settings.nodes import HARDWARE_BRIDGE, NODES
from furuta.settings.settings import Settings
from furuta_bringup.graph.composed_graph import HardwareGraph, SimulatedGraph
from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_hw.connection import rig_connection
from furuta_ros.testing import Bench
from furuta_sim import lockstep

# Logs, catches or ends what fails: not itself made to fail.
MACHINERY = {"guarded", "report_failure", "warn", "destroy_node", "close", "summary"}
MADE = "made to fail"


@pytest.mark.parametrize("name", NODES)
def test_no_callback_lets_an_exception_out(bench: Bench, name: str) -> None:
    """Not even one that is called with nonsense."""
    node = bench.add(NODES[name].load_class()([]))
    for service in node.services:
        assert service.callback(object(), "the response") == "the response", service.srv_name
    for each in (*node.timers, *node.subscriptions):
        each.callback(object(), {"source_timestamp": "nonsense"})


def parts_of(thing: Any, known: set[type]) -> set[type]:
    """The classes of this workspace that an object and what it holds are made of."""
    for kind in type(thing).__mro__:
        if kind.__module__.startswith("furuta_") and not issubclass(kind, tuple):
            known.add(kind)
    for value in getattr(thing, "__dict__", {}).values():
        if type(value).__module__.startswith("furuta_") and type(value) not in known:
            parts_of(value, known)
    return known


def methods_of(kinds: set[type]) -> Iterator[tuple[type, str]]:
    for kind in sorted(kinds, key=lambda kind: kind.__qualname__):
        for name, value in vars(kind).items():
            if inspect.isfunction(value) and not name.startswith("__") and name not in MACHINERY:
                yield kind, name


class Failing:
    """Makes one of the methods of classes fail, once."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, kinds: set[type]) -> None:
        self.methods = list(methods_of(kinds))
        self.chosen: tuple[type, str] | None = None
        for kind, name in self.methods:
            monkeypatch.setattr(kind, name, self._failing(kind, name, vars(kind)[name]))

    def _failing(self, kind: type, name: str, original: Callable[..., Any]) -> Callable[..., Any]:
        def call(*given: Any, **named: Any) -> Any:
            if self.chosen == (kind, name):
                self.chosen = None
                raise RuntimeError(MADE)
            return original(*given, **named)

        call.__name__ = name
        return call


def spin(graph: Any, seconds: float, until: Callable[[], bool]) -> bool:
    end = monotonic() + seconds
    while not until() and monotonic() < end:
        graph.executor.spin_once(timeout_sec=0.005)
    return until()


def fail_each(
    graph: Any,
    failing: Failing,
    nodes: Any,
    samples: Callable[[], int],
    goes_on: Callable[[str], None],
) -> set[str]:
    """Let each method fail while timers and services of ``nodes`` are called; those that did."""
    failed = set()
    for kind, name in failing.methods:
        failing.chosen = kind, name
        for node in nodes:
            for timer in node.timers:
                timer.callback()
            for service in node.services:
                service.callback(service.srv_type.Request(), service.srv_type.Response())
        end = samples() + 30
        spin(graph, 1.0, lambda end=end: failing.chosen is None or samples() > end)
        if failing.chosen is None:
            failed.add(f"{kind.__name__}.{name}")
        failing.chosen = None
        goes_on(f"{kind.__name__}.{name}")
    return failed


def test_a_graph_goes_on(ros: None, settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each method of its nodes fails once, and the plant's time goes on."""
    monkeypatch.setattr(lockstep, "REPEAT_AFTER", 0.02)
    monkeypatch.setattr(lockstep, "SETTLE_TIME", 0.02)
    settings["plant"] |= {"clock": "lockstep"}
    settings["friction_observer"] |= {"compensation": "recommended"}
    graph = SimulatedGraph(settings)
    kinds = set().union(*(parts_of(node, set()) for node in graph.nodes))
    graph.close()
    failing = Failing(monkeypatch, kinds)
    graph = SimulatedGraph(settings)
    spin(graph, 10.0, lambda: graph.plant.sample > 100)

    def goes_on(what: str) -> None:
        before = graph.plant.sample
        assert spin(graph, 20.0, lambda: graph.plant.sample > before + 20), what

    failed = fail_each(graph, failing, graph.nodes, lambda: graph.plant.sample, goes_on)
    graph.close()
    assert {"PlantNode.on_command", "EstimatorNode.on_measurement", "LockStep._check"} <= failed


@pytest.mark.filterwarnings("error::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_rig_is_driven_or_stopped(
    ros: None, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each method of the bridge, of what it holds and of the driver fails once."""
    monkeypatch.setattr(rig_connection, "RETRY_PERIOD", 0.1)
    settings["hardware_bridge"] |= {"port": "mock", "autostart": "active"}
    graph = HardwareGraph(settings)
    graph.bridge.start_up()
    kinds = parts_of(graph.bridge, set())
    graph.close()
    failing = Failing(monkeypatch, kinds)
    graph = HardwareGraph(settings)
    bridge: Any = graph.bridge
    bridge.start_up()

    def is_sound() -> bool:
        stands = bridge.guard.reason and bridge.connection._driver._port._rig.drive_volts == 0.0
        return bool(bridge.guard.armed or stands)

    def goes_on(what: str) -> None:
        before = bridge.samples
        assert spin(graph, 20.0, lambda: bridge.samples > before and is_sound()), what
        spin(graph, 1.0, lambda: not bridge.arm())

    failed = fail_each(graph, failing, [], lambda: bridge.samples, goes_on)
    graph.close()
    assert {"HardwareBridgeNode._receive", "GuardedRig.samples", "Guard.measured"} <= failed
    assert {"RigConnection.drive", "SerialProtocolDriver.decode"} <= failed


@pytest.mark.parametrize(
    ("before", "transition", "method"),
    [
        ("unconfigured", Transition.TRANSITION_CONFIGURE, "on_configure"),
        ("inactive", Transition.TRANSITION_ACTIVATE, "on_activate"),
        ("active", Transition.TRANSITION_DEACTIVATE, "on_deactivate"),
        ("inactive", Transition.TRANSITION_CLEANUP, "on_cleanup"),
        ("active", Transition.TRANSITION_ACTIVE_SHUTDOWN, "on_cleanup"),  # on_shutdown is the same
    ],
)
def test_a_transition_fails(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, before: str, transition: int, method: str
) -> None:
    """The rig is not driven, the node says why, and its services answer."""
    original, failures = getattr(HardwareBridgeNode, method), [RuntimeError(MADE)]

    def fail_once(node: Any, state: LifecycleState) -> TransitionCallbackReturn:
        if failures:
            raise failures.pop()
        return original(node, state)  # type: ignore[no-any-return]

    fail_once.__name__ = method
    for name in ("on_shutdown", "on_error") if method == "on_cleanup" else ():
        monkeypatch.setattr(HardwareBridgeNode, name, fail_once)
    monkeypatch.setattr(HardwareBridgeNode, method, fail_once)
    given = {"port": "mock", "autostart": before}
    node = bench.add(HardwareBridgeNode([Parameter(k, value=v) for k, v in given.items()]))
    node.start_up()
    request = node._service_change_state.srv_type.Request(transition=Transition(id=transition))
    response = node._service_change_state.srv_type.Response()
    node._service_change_state.callback(request, response)
    assert not response.success
    assert method in node.failure
    assert MADE in node.failure
    assert not node.guard.armed
    assert node.connection is None
    assert node.status().level != b"\0"
    assert node.get_name() == HARDWARE_BRIDGE
