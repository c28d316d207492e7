"""The composed graph in lock-step: equal to the offline loop, repeatable to the last bit.

``FURUTA_LANES`` tries 20 random loops, of the kinds whose lanes ``test_lanes.py`` compares with
single runs; the suite tries two.
"""

import os
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from random_loops import LAWS, METHODS, random_loop
from rclpy.serialization import deserialize_message
from rosbags.highlevel import AnyReader
from std_msgs.msg import String

from furuta.settings.settings import Settings, default_settings, load_settings, loop
from furuta.studies.swing_up import swing_up_settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_friction.compensation import COMPENSATIONS
from furuta_hw.rigs.known_rigs import find_rig
from furuta_model.accepted_parts import accept_parts
from furuta_model.parameters import values
from furuta_model.state import THETA
from furuta_recordings.bags.recorded_loop import read_recorded_run
from furuta_recordings.recorder_node import RecorderNode
from furuta_ros.topics import ACTIVE_MODE, TOPICS
from furuta_sim.simulation.closed_loop import Record, simulate

RANDOM_LOOPS = 20 if os.environ.get("FURUTA_LANES") else 2
# Every part of the plant that the control system does not know, at once.
ALL_PARTS = [
    "plant.friction.variation.angle=0.2",
    "plant.cogging.torque=0.02",
    "plant.pendulum_friction.damping=0.0005",
    "plant.pendulum_friction.coulomb=0.001",
    "plant.drive.delay=2",
    "plant.drive.lag=0.002",
    "plant.drive.dead_band=0.01",
    "plant.sensor_faults.reading_delay=1",
    "plant.sensor_faults.missing=0.02",
    "plant.sensor_faults.stuck=tachometer",
    "plant.sensor_faults.stuck_from=2.99",
    "plant.sensor_faults.arm_bias=0.02",
    "plant.sensor_faults.arm_speed_bias=0.01",
    "plant.sensor_faults.pendulum_bias=0.002",
    "plant.pushes.times=[0.5, 1.0, 1.2]",
    "plant.pushes.durations=[0.05]",
    "plant.pushes.arm=[0.2, 0.0, -0.2]",
    "plant.pushes.pendulum=[0.0, 0.01, 0.0]",
    "plant.pushes.base_x=[0.0, 0.01, 0.02]",
    "plant.pushes.base_y=[0.01]",
]
# Functions of one's own.
OWN = ["plant.friction.law=own_parts:LUGRE", "estimator.method=own_parts:differences"]


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


def require_graph_is_the_offline_loop(
    settings: Settings, bag: Path, seconds: float = 3.0
) -> Record:
    """The graph in lock-step and the offline simulation agree to the last bit."""
    expected = simulate(loop(settings), seconds)
    recorded = read_recorded_run(record(settings, seconds, bag))
    assert len(recorded.time) == round(seconds / expected.sample_time)
    np.testing.assert_array_equal(recorded.state, expected.state)
    np.testing.assert_array_equal(recorded.friction, expected.friction)
    np.testing.assert_array_equal(recorded.friction_estimate, expected.friction_estimate)
    np.testing.assert_array_equal(recorded.command, expected.command)
    return expected


@pytest.mark.parametrize(
    "chosen",
    [
        ["compensation=lugre"],
        ["compensation=coulomb", "sensors.ideal=true"],
        ["compensation=adaptive", "plant.friction.law=maxwell_slip", *ALL_PARTS],
        ["compensation=recommended", "integral_time=5.0", "phi=2.0"],
        ["compensation=recommended", "drive.delay=7", "drive.lag=0.012", "bandwidth=70"],
        ["compensation=own_parts:counting", "mode=own_parts:feedback", *OWN],
    ],
    ids=lambda chosen: " ".join(chosen[:2]),
)
def test_graph_is_the_offline_loop(
    ros: None, no_parts: None, tmp_path: Path, chosen: list[str]
) -> None:
    """Nodes and offline simulation call the same functions: equal to the last bit."""
    accept_parts(f"own_parts:{name}" for name in ("LUGRE", "counting", "differences", "feedback"))
    require_graph_is_the_offline_loop(load_settings([], chosen), tmp_path / "bag")


@pytest.mark.long
def test_graph_swings_up_as_the_offline_loop(ros: None, tmp_path: Path) -> None:
    """So they are from hanging to upright, through every phase."""
    settings = swing_up_settings(find_rig("odrive_furuta"))
    run = require_graph_is_the_offline_loop(settings, tmp_path / "bag")
    assert np.cos(run.state[-1, THETA]) > 0.95
    messages = raw_messages(tmp_path / "bag")["active_mode"]
    modes = [deserialize_message(each, String).data for each in messages]
    assert modes[0] == "off"
    assert modes[-2:] == ["catch", "balance"]


@pytest.mark.parametrize("seed", range(RANDOM_LOOPS))
def test_graph_with_a_random_loop_is_the_offline_loop(ros: None, tmp_path: Path, seed: int) -> None:
    """Any law, compensation, estimator and sensors; some pendulums fall."""
    r = np.random.default_rng(seed)
    law, compensation, method = (str(r.choice(each)) for each in (LAWS, COMPENSATIONS, METHODS))
    chosen = random_loop(r, law, compensation, method, bool(r.integers(2)))
    settings = default_settings() | {
        "plant": values(chosen.plant),
        "estimator": values(chosen.estimator),
        "friction_observer": values(chosen.observer),
        "controller": values(chosen.controller),
    }
    assert loop(settings) == chosen
    require_graph_is_the_offline_loop(settings, tmp_path / "bag", 2.0)


def test_one_seed_one_run(ros: None, tmp_path: Path) -> None:
    """Two runs with one seed are equal on every topic to the last bit; another seed differs."""
    bags = [
        raw_messages(record(load_settings([], [f"seed={seed}"]), 2.0, tmp_path / name))
        for name, seed in (("a", 1), ("b", 1), ("c", 2))
    ]
    assert set(bags[0]) == {topic.name for topic in (*TOPICS, ACTIVE_MODE)}
    assert {len(bags[0][topic.name]) for topic in TOPICS} == {2000}
    assert bags[0] == bags[1]
    for topic in bags[0]:
        if topic not in ("friction_estimate", "active_mode"):  # 0 V and balance for any seed
            assert bags[0][topic] != bags[2][topic]
