"""The composed graph in real time."""

from time import monotonic

import pytest
from rclpy.parameter import Parameter

from furuta.settings.settings import Settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_ros.spinning import spin_until

pytestmark = pytest.mark.realtime


def test_pendulum_is_held_upright(ros: None, settings: Settings) -> None:
    """Three seconds at 1 kHz: upright, samples commanded in time, no lost time."""
    graph = SimulatedGraph(settings)
    spin_until(graph.executor, lambda: graph.plant.sample > 0)
    begin, start = monotonic(), graph.plant.time
    spin_until(graph.executor, lambda: monotonic() > begin + 3.0)
    elapsed = monotonic() - begin
    count = graph.plant.pacing.timing_counts
    theta = graph.plant.x[2]
    seconds = graph.plant.time - start
    graph.close()
    assert abs(theta) < 0.2
    # The fraction depends on the load of the machine; the benchmark measures it.
    assert count.on_time > 0.5 * count.samples > 500
    assert abs(seconds - elapsed) < 0.5


def test_a_command_does_not_age_in_a_pause(ros: None, settings: Settings) -> None:
    """The first sample after a pause longer than the timeout uses it."""
    settings["plant"]["command_timeout"] = 1.0  # longer than the machine may stall
    graph = SimulatedGraph(settings)
    plant = graph.plant
    spin_until(graph.executor, lambda: plant.pacing.timing_counts.samples > 200)
    plant.set_parameters([Parameter("run_until", value=plant.time)])
    resumed = monotonic() + 1.2
    spin_until(graph.executor, lambda: monotonic() > resumed)
    plant.set_parameters([Parameter("run_until", value=plant.time + 0.2)])
    spin_until(graph.executor, lambda: plant.paused)
    timeouts = plant.pacing.timing_counts.timeouts
    graph.close()
    assert timeouts == 0
