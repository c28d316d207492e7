"""The node ``plant`` in lock-step while nodes are missing or messages are lost."""

from typing import Any

import pytest
from rclpy.parameter import Parameter

from furuta_ros.testing import Bench
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, MEASUREMENT
from furuta_sim import lockstep
from furuta_sim.plant_node import PlantNode


def plant(bench: Bench) -> PlantNode:
    return bench.add(PlantNode([Parameter("clock", value="lockstep")]))


def test_a_plant_alone_says_who_is_missing(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, capfd: Any
) -> None:
    """Before the first sample too, again and again, and within five seconds."""
    assert lockstep.WARN_AFTER < 5.0
    monkeypatch.setattr(lockstep, "WARN_AFTER", 0.2)
    plant(bench)
    warnings = ""

    def warned() -> bool:
        nonlocal warnings
        warnings += capfd.readouterr().err
        return warnings.count("waiting for the command to sample 0") >= 3

    bench.spin(warned)
    for text in (
        "no node subscribes to /measurement",
        "no node publishes /joint_states",
        "no node publishes /friction_estimate",
        "no node publishes /command",
    ):
        assert warnings.count(text) >= 3


def test_the_run_starts_when_no_topic_waits_for_a_publisher(bench: Bench) -> None:
    """A node that joins in the middle of repetitions would get some of them only."""
    plant(bench)
    estimates = bench.collect(FRICTION_ESTIMATE)
    measurements = bench.collect(MEASUREMENT)
    bench.publisher(COMMAND)
    bench.settle(1.0)
    assert measurements == []
    bench.publisher(FRICTION_ESTIMATE)
    bench.spin(lambda: len(measurements) == 1)
    assert estimates == []


def test_a_recorder_does_not_delay_the_run_for_ever(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A graph without friction observer starts too, after a while."""
    monkeypatch.setattr(lockstep, "INCOMPLETE_AFTER", 0.5)
    plant(bench)
    bench.collect(FRICTION_ESTIMATE)
    measurements = bench.collect(MEASUREMENT)
    bench.publisher(COMMAND)
    bench.spin(lambda: len(measurements) >= 1)
