"""Graphs as they are started: launched with a rig, in namespaces."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paused_graph import PausedGraph, launch_commands
from testbench import Bench

from furuta_graph.graph_plan import GraphOptions, plan_graph
from furuta_graph.settings.settings import load_settings, loop
from furuta_sim.simulation.closed_loop import simulate

SAMPLES = 300


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


@pytest.mark.parametrize(
    "extra",
    [(), pytest.param(("--processes",), marks=pytest.mark.long)],
    ids=["composed", "processes"],
)
def test_two_graphs_side_by_side(bench: Bench, processes: Any, extra: tuple[str, ...]) -> None:
    """In one ROS domain each namespace has its own pendulum, clients included."""
    seeds = {"left": 1, "right": 2}
    graphs = {name: PausedGraph(bench, name) for name in seeds}
    for name, seed in seeds.items():
        assignments = ("--set", f"seed={seed}", "--set", "run_until=0")
        processes.furuta("run", "--lockstep", "--namespace", name, *extra, *assignments)
    for name, seed in seeds.items():
        expected = simulate(loop(load_settings([], [f"seed={seed}"])), SAMPLES * 0.001)
        np.testing.assert_array_equal(graphs[name].run(SAMPLES), expected.state)
    assert processes.run("param", "get", "/right/plant", "seed")[1].strip() == "2"
