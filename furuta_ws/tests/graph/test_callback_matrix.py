"""Every callback, task and transition fails once: the node lives on, or the rig stands at 0 V."""

import inspect
from collections.abc import Callable
from time import monotonic
from typing import Any

import pytest
from bridge_bench import bridge
from diagnostic_msgs.msg import DiagnosticStatus

from furuta.settings.nodes import NODES
from furuta.settings.settings import Settings
from furuta_bringup.graph.composed_graph import ComposedGraph, HardwareGraph, SimulatedGraph
from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_hw.connection import rig_connection
from furuta_ros.testing import Bench
from furuta_sim import lockstep

# Logs, catches or ends what fails: not itself made to fail.
MACHINERY = {"guarded", "report_failure", "warn", "destroy_node", "close", "summary"}
MADE = "made to fail"
# Some of the methods that must have failed, or this file tests nothing.
FAILED = {
    SimulatedGraph: {"PlantNode.on_command", "EstimatorNode.on_measurement", "LockStep._check"},
    HardwareGraph: {"HardwareBridgeNode._receive", "Guard.measured", "SerialProtocolDriver.decode"},
}


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
        module = type(value).__module__  # an emulated rig is none of our nodes
        if module.startswith("furuta_") and ".emulator" not in module and type(value) not in known:
            parts_of(value, known)
    return known


class Failing:
    """Makes the ``chosen`` one of all methods of classes fail, once."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, kinds: set[type]) -> None:
        self.chosen = ""
        self.methods = []
        for kind in sorted(kinds, key=lambda kind: kind.__name__, reverse=True):
            for name, value in list(vars(kind).items()):
                is_plain = inspect.isfunction(value) and not name.startswith("__")
                if is_plain and name not in MACHINERY:
                    self.methods.append(f"{kind.__name__}.{name}")
                    monkeypatch.setattr(kind, name, self._failing(self.methods[-1], value))

    def _failing(self, method: str, original: Callable[..., Any]) -> Callable[..., Any]:
        def call(*given: Any, **named: Any) -> Any:
            if self.chosen == method:
                self.chosen = ""
                raise RuntimeError(MADE)
            return original(*given, **named)

        call.__name__ = original.__name__
        return call


def spin(graph: ComposedGraph, seconds: float, until: Callable[[], bool]) -> bool:
    end = monotonic() + seconds
    while not until() and monotonic() < end:
        graph.executor.spin_once(timeout_sec=0.005)
    return until()


@pytest.mark.filterwarnings("error::pytest.PytestUnhandledThreadExceptionWarning")
@pytest.mark.parametrize("kind", FAILED)
def test_each_method_fails(
    ros: None, settings: Settings, monkeypatch: pytest.MonkeyPatch, kind: type[ComposedGraph]
) -> None:
    """Of all nodes, or of the bridge and its driver: samples go on, and a rig is safe."""
    monkeypatch.setattr(lockstep, "REPEAT_AFTER", 0.02)
    monkeypatch.setattr(lockstep, "SETTLE_TIME", 0.02)
    monkeypatch.setattr(rig_connection, "RETRY_PERIOD", 0.1)
    settings["plant"] |= {"clock": "lockstep"}
    settings["hardware_bridge"] |= {"port": "mock", "autostart": "active"}
    settings["friction_observer"] |= {"compensation": "recommended"}

    def started() -> tuple[ComposedGraph, Any]:
        graph = kind(settings)
        graph.node(kind.controlled).start_up()
        return graph, graph.nodes[0]

    graph, _ = started()
    count = len(graph.nodes) if kind is SimulatedGraph else 1
    kinds = set().union(*(parts_of(node, set()) for node in graph.nodes[:count]))
    graph.close()
    failing = Failing(monkeypatch, kinds)
    graph, node = started()

    def samples() -> int:
        return int(node.sample if kind is SimulatedGraph else node.samples)

    def is_safe() -> bool:
        if kind is SimulatedGraph or node.guard.armed:
            return True
        return node.guard.reason and node.connection._driver._port._rig.drive_volts == 0.0

    failed = set()
    for method in failing.methods:
        failing.chosen = method
        for each in graph.nodes[:count]:
            for timer in each.timers:
                timer.callback()
            for service in each.services:
                service.callback(service.srv_type.Request(), service.srv_type.Response())
        before = samples()  # a reset leaves some out
        spin(graph, 1.0, lambda n=before: not failing.chosen or samples() > n + 10)
        failed |= set() if failing.chosen else {method}
        before, failing.chosen = samples(), ""
        assert spin(graph, 20.0, lambda n=before: samples() > n + 5 and is_safe()), method
        if kind is HardwareGraph:
            spin(graph, 1.0, lambda: not node.arm())
    graph.close()
    assert failed >= FAILED[kind]


@pytest.mark.parametrize(
    ("before", "transition"),
    [
        ("unconfigured", "configure"),
        ("inactive", "activate"),
        ("active", "deactivate"),
        ("inactive", "cleanup"),
        ("active", "shutdown"),
    ],
)
def test_a_transition_fails(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, before: str, transition: str
) -> None:
    """The line is closed, and log and status say why."""
    failing = Failing(monkeypatch, {HardwareBridgeNode})
    node = bridge(bench, autostart=before)
    failing.chosen = f"HardwareBridgeNode.on_{transition}"
    getattr(node, f"trigger_{transition}")()
    assert (failing.chosen, node.guard.armed, node.connection) == ("", False, None)
    assert MADE in node.status().message
    assert node.status().level == DiagnosticStatus.ERROR
