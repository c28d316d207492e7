"""The composed graph in lock-step: equal to the offline loop, repeatable to the last bit."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from furuta_analysis.simulation.closed_loop import simulate
from furuta_analysis.simulation.oscillation import measure_oscillation
from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.settings import Settings, load_settings, loop
from furuta_recordings.bags.recorded_run import read_recorded_run
from furuta_recordings.recorder_node import RecorderNode
from furuta_ros.topics import TOPICS

IDEAL = ["sensors.ideal=true"]


def record(settings: Settings, seconds: float, bag: Path) -> Path:
    """Run the graph in lock-step and record it."""
    settings["plant"] |= {"clock": "lockstep", "run_until": seconds}
    graph = SimulatedGraph(settings, record=partial(RecorderNode, bag, stamped=True))
    graph.run_until(seconds)
    graph.close()
    return bag


def raw_messages(bag: Path) -> dict[str, list[bytes]]:
    """The serialised messages of every topic."""
    messages: dict[str, list[bytes]] = {}
    with AnyReader([bag]) as reader:
        for connection, _, data in reader.messages():
            messages.setdefault(connection.topic.lstrip("/"), []).append(bytes(data))
    return messages


@pytest.mark.parametrize("compensation", ["none", "coulomb", "lugre"])
def test_graph_is_the_offline_loop(ros: None, tmp_path: Path, compensation: str) -> None:
    """Nodes and offline simulation call the same functions: equal to the last bit."""
    settings = load_settings([], [f"compensation={compensation}"])
    expected = simulate(loop(settings), 3.0)
    recorded = read_recorded_run(record(settings, 3.0, tmp_path / "bag"))
    assert len(recorded.time) == 3000
    np.testing.assert_array_equal(recorded.state, expected.state)
    np.testing.assert_array_equal(recorded.friction, expected.friction)
    np.testing.assert_array_equal(recorded.friction_estimate, expected.friction_estimate)
    np.testing.assert_array_equal(recorded.command, expected.command)


def test_one_seed_one_run(ros: None, tmp_path: Path) -> None:
    """Two runs with one seed are equal on every topic to the last bit; another seed differs."""
    bags = [
        raw_messages(record(load_settings([], [f"seed={seed}"]), 2.0, tmp_path / name))
        for name, seed in (("a", 1), ("b", 1), ("c", 2))
    ]
    assert set(bags[0]) == {topic.name for topic in TOPICS}
    assert {len(messages) for messages in bags[0].values()} == {2000}
    assert bags[0] == bags[1]
    for topic in bags[0]:
        if topic != "friction_estimate":  # 0 V without compensation for any seed
            assert bags[0][topic] != bags[2][topic]


def test_limit_cycle_with_ideal_sensors(ros: None, tmp_path: Path) -> None:
    """On the graph: 0.5106 rad, 0.0918 rad, 2.370 s, each within 1 %."""
    bag = record(load_settings([], IDEAL), 30.0, tmp_path / "bag")
    settled = read_recorded_run(bag).between(15.0, 30.0)
    measured = measure_oscillation(settled.state, 0.001)
    assert measured.phi_peak_to_peak_rad == pytest.approx(0.5106, rel=0.01)
    assert measured.theta_peak_to_peak_rad == pytest.approx(0.0918, rel=0.01)
    assert measured.period_s == pytest.approx(2.370, rel=0.01)
