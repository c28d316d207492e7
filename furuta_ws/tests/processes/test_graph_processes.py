"""Graphs as they are started: one process per node, launched, in namespaces, two at once."""

import signal
from functools import wraps
from itertools import pairwise
from pathlib import Path
from shutil import rmtree
from time import sleep
from typing import Any

import numpy as np
import pytest
from paused_graph import PausedGraph, launch_commands
from processes.conftest import wait_for
from rosbags.highlevel import AnyReader

from furuta.settings.nodes import graph_nodes
from furuta.settings.settings import load_settings, loop
from furuta_bringup.graph.graph_plan import GraphOptions, plan_graph
from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import Bag
from furuta_recordings.bags.recovery import recover
from furuta_ros.node import deep
from furuta_ros.testing import Bench
from furuta_ros.topics import GROUND_TRUTH, TOPICS
from furuta_sim.simulation.closed_loop import simulate

SAMPLES = 300
NODE_NAMES = [node.name for node in graph_nodes()]


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

    bench.probe.create_subscription(GROUND_TRUTH.message, GROUND_TRUTH.name, callback, deep(10_000))
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
def test_nodes_end_cleanly(processes: Any, number: int) -> None:
    """With status 0 and no traceback, also if the signal comes again while they end."""
    running = [processes.node(name) for name in NODE_NAMES]
    for process in running:
        assert "ready" in process.stderr.readline()
    for process in running:
        process.send_signal(number)
    sleep(0.06)
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
    assert out == "500 samples, 0.500 s\n"
    assert "running: simulation in lock-step, namespace /, ROS domain" in err
    assert "Ctrl-C ends it, furuta view --attach shows it\n" in err
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
    wait_for(lambda: messages(bag))
    process.send_signal(signal.SIGINT)
    out, err = process.communicate()
    assert process.returncode == 0, err
    assert " samples, " in out
    with AnyReader([bag]) as reader:
        changes = {"/parameter_events", "/active_mode", "/rosout"}
        assert {c.topic for c in reader.connections} == {"/command", *changes}


def messages(bag: Path) -> int:
    """Number of commands so far; /rosout has messages before the graph is ready."""
    recovered = bag.with_name("recovered")
    rmtree(recovered, ignore_errors=True)
    try:
        recover(bag, recovered)
    except ParameterError:  # nothing yet
        return 0
    with Bag(recovered) as reader:
        return sum(c.msgcount for c in reader.connections if c.topic == "/command")


def test_launched_graph_on_another_rig(
    bench: Bench, processes: Any, other_rig: Path, tmp_path: Path
) -> None:
    """The launch file's processes run the rig of ``rig:=`` as the simulation does, to the bit."""
    file = tmp_path / "mine.yaml"
    file.write_text(
        "plant: {ros__parameters: {run_until: 0.0, seed: 4}}\n"
        "friction_observer: {ros__parameters: {compensation: lugre}}\n"
    )
    arguments = {"rig": str(other_rig), "params_file": str(file), "namespace": "left"}
    graph = PausedGraph(bench, "left", sample_time=0.002)
    for command in launch_commands(clock="lockstep", **arguments):
        processes.start(*command)
    plan = plan_graph(GraphOptions(rig=str(other_rig)), [file])
    expected = simulate(loop(plan.settings), SAMPLES * 0.002)
    np.testing.assert_array_equal(graph.run(SAMPLES), expected.state)


def test_two_graphs_side_by_side(bench: Bench, processes: Any) -> None:
    """In one ROS domain each namespace has its own pendulum, clients included."""
    seeds = {"left": 1, "right": 2}
    graphs = {name: PausedGraph(bench, name) for name in seeds}
    for name, seed in seeds.items():
        assignments = ("--set", f"seed={seed}", "--set", "run_until=0")
        processes.furuta("run", "--lockstep", "--namespace", name, *assignments)
    for name, seed in seeds.items():
        expected = simulate(loop(load_settings([], [f"seed={seed}"])), SAMPLES * 0.001)
        np.testing.assert_array_equal(graphs[name].run(SAMPLES), expected.state)
    assert processes.run("param", "get", "/right/plant", "seed")[1].strip() == "2"


def test_a_second_graph_does_not_start(processes: Any) -> None:
    """Beside one in its namespace and domain, until that one has ended, by a kill too."""
    first = processes.ready_node("plant")
    status, _, err = processes.run("run", "--lockstep")
    assert status == 1
    assert "a graph already runs in namespace / of ROS domain" in err
    assert "computer: furuta view --attach shows it; or end it" in err
    assert (status, "", err) == processes.run("view", "--no-open")  # no address of a dead page
    assert (status, "", err) == processes.run("run", "--processes")
    assert first.poll() is None
    first.send_signal(signal.SIGKILL)
    first.wait()
    status, out, err = processes.run("run", "--lockstep", "--seconds", "2")
    assert (status, out) == (0, "2000 samples, 2.000 s\n"), err


def test_a_plant_of_its_own_process_prints_its_counts(processes: Any) -> None:
    """As ``run`` does: its parent may be ``run --processes`` or ``ros2 launch``."""
    plant = processes.ready_node("plant")
    plant.send_signal(signal.SIGINT)
    out, _ = plant.communicate()
    count, on_time, latency, lateness = out.splitlines()
    assert " samples, " in count
    assert "0.00% of " in on_time
    assert (latency.split()[0], lateness.split()[0]) == ("latency", "lateness")
