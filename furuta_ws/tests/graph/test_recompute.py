"""Recomputation of a recorded lock-step session, with the same and with another tuning."""

from functools import partial
from pathlib import Path

import pytest
from rclpy.node import Node

from furuta.figures.series import draw_recomputation
from furuta.studies.recomputation import compare, recompute_bag
from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.parameter_client import ParameterClient
from furuta_recordings.recorder_node import RecorderNode
from furuta_ros.context import ros_context
from furuta_sim.settings.parameter_files import settings_file
from furuta_sim.settings.settings import load_settings


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    """Two seconds without compensation, then one with LuGre, in a namespace."""
    with ros_context(namespace="/left"):
        settings = load_settings(
            [], ["controller.omega1=8", "plant.seed=3", "controller.excitation.kind=sine"]
        )
        settings["plant"] |= {"clock": "lockstep", "run_until": 0.0}
        node = Node("node")
        recorder = partial(
            RecorderNode, tmp_path / "bag", stamped=True, parameters=settings_file(settings)
        )
        graph = SimulatedGraph(settings, [node], recorder)
        client = ParameterClient(node, graph.executor)
        client.set("plant", run_until=2.0)
        graph.run_until(2.0)
        client.set("friction_observer", compensation="lugre", alpha0=0.2)
        client.set("plant", run_until=3.0)
        graph.run_until(3.0)
        graph.close()
    return tmp_path / "bag"


def test_recomputation_equals_recording(bag: Path) -> None:
    """The bag holds the parameters and their changes, so the recomputation is the recording."""
    result = compare(*recompute_bag(bag, (), ()))
    assert result["samples"] == 3000
    assert result["identical"]
    assert result["command"]["compared"] == 3000


def test_another_tuning_changes_estimate_and_command(bag: Path, tmp_path: Path) -> None:
    """Another level changes the friction estimate and the command, not the state estimate."""
    recorded, recomputed = recompute_bag(bag, (), ("friction_observer.alpha0=0.1",))
    result = compare(recorded, recomputed)
    assert result["estimate"]["identical"]
    assert not result["command"]["identical"]
    assert 0.05 < result["friction_estimate"]["largest_difference"] < 0.15
    assert (recorded.command[:2000] == recomputed.command[:2000]).all()
    draw_recomputation(recorded, recomputed, tmp_path / "recomputation.png")
    assert (tmp_path / "recomputation.png").stat().st_size > 10_000
