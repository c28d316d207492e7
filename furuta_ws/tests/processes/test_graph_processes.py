"""The graph as one process per node, with parameters set from outside."""

import signal
from functools import wraps
from itertools import pairwise
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import numpy as np
import pytest
from paused_graph import PausedGraph
from rosbags.highlevel import AnyReader
from testbench import Bench

from furuta_graph.settings.nodes import graph_nodes
from furuta_graph.settings.settings import load_settings, loop
from furuta_recordings.bags.bag import Bag
from furuta_ros.topics import GROUND_TRUTH, TOPICS, deep
from furuta_sim.simulation.closed_loop import simulate

SAMPLES = 1500
NODE_NAMES = [node.name for node in graph_nodes()]


@pytest.mark.long
def test_separate_processes_are_the_same_loop(bench: Bench, processes: Any) -> None:
    """In lock-step, four processes give the offline loop's run to the last bit."""
    graph = PausedGraph(bench)
    for name in NODE_NAMES:
        extra = ("clock:=lockstep", "run_until:=0.0") if name == "plant" else ()
        processes.node(name, *extra, *(("compensation:=lugre",) if "observer" in name else ()))
    expected = simulate(loop(load_settings([], ["compensation=lugre"])), SAMPLES * 0.001)
    np.testing.assert_array_equal(graph.run(SAMPLES), expected.state)


@pytest.mark.long
def test_killed_controller_is_replaced(bench: Bench, processes: Any) -> None:
    """Lock-step stops when a node is killed and continues when it is back."""
    running = {
        name: processes.node(name, *(("clock:=lockstep",) if name == "plant" else ()))
        for name in NODE_NAMES
    }
    truths: list[tuple[int, int]] = []

    def receive(truth: Any, info: dict[str, Any]) -> None:
        stamp = truth.header.stamp.sec * 10**9 + truth.header.stamp.nanosec
        truths.append((stamp, info["publication_sequence_number"]))

    @wraps(receive)  # the two arguments tell rclpy to pass the message info
    def callback(*taken: Any) -> None:
        receive(*(taken if len(taken) == 2 else taken[0]))

    bench.probe.create_subscription(GROUND_TRUTH.type, GROUND_TRUTH.name, callback, deep(10_000))
    bench.spin(lambda: len(truths) > 10, timeout=120.0)
    stops = []
    for name in ("controller", "friction_observer", "estimator"):
        running[name].send_signal(signal.SIGKILL)
        running[name].wait()
        bench.settle()
        stops.append(len(truths))
        processes.node(name)
        bench.spin(lambda: len(truths) > stops[-1] + 200, timeout=120.0)
    # This test may miss messages: the plant does not wait for it. The plant misses no sample.
    assert all(b - a == (n - m) * 1_000_000 for (a, m), (b, n) in pairwise(truths))


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("again", [0.02, 0.06, 0.2])
def test_nodes_end_cleanly(processes: Any, number: int, again: float) -> None:
    """With status 0 and no traceback, also if the signal comes again while they end."""
    running = [processes.node(name) for name in NODE_NAMES]
    for process in running:
        assert "ready" in process.stderr.readline()
    for process in running:
        process.send_signal(number)
    sleep(again)
    for process in running:
        process.send_signal(number)
    for process in running:
        _, err = process.communicate(timeout=120.0)
        assert process.returncode == 0, err
        assert "Traceback" not in err


def test_run_records_all_topics(furuta: Any, tmp_path: Path) -> None:
    """``furuta run --record`` writes a bag with every topic and changes of parameters."""
    bag = tmp_path / "bag"
    status, out, err = furuta("run", "--lockstep", "--seconds", "0.5", "--record", bag)
    assert status == 0, err
    assert "500 samples" in out
    with AnyReader([bag]) as reader:
        counts = {c.topic.lstrip("/"): c.msgcount for c in reader.connections}
    del counts["rosout"]  # as many as the nodes log
    changes = {"parameter_events": 0, "active_mode": 2}  # off, balance
    assert counts == {topic.name: 500 for topic in TOPICS} | changes


@pytest.mark.long
def test_processes_are_recorded(processes: Any, tmp_path: Path) -> None:
    """``--processes`` with ``--record``: selected topics only; Ctrl-C finishes the bag."""
    bag = tmp_path / "bag"
    process = processes.furuta(
        "run", "--processes", "--lockstep", "--record", bag, "--topic", "command"
    )
    deadline = monotonic() + 120.0
    while not (bag / "metadata.yaml").exists() or not messages(bag):
        assert monotonic() < deadline
        sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 0, err
    with AnyReader([bag]) as reader:
        changes = {"/parameter_events", "/active_mode", "/rosout"}
        assert {c.topic for c in reader.connections} == {"/command", *changes}


def messages(bag: Path) -> int:
    """Number of commands; /rosout has messages before the graph is ready."""
    with Bag(bag) as reader:
        return sum(c.msgcount for c in reader.connections if c.topic == "/command")
