"""A second publisher on the topics of a node in real time."""

from typing import Any

from std_msgs.msg import Float64
from testbench import Bench

from furuta_ros.topics import COMMAND
from furuta_sim.plant_node import PlantNode


def test_a_second_command_does_not_drive_the_arm(bench: Bench, capfd: Any) -> None:
    """The first publisher stays in command at 0 V; the second one is named."""
    node = bench.add(PlantNode())
    first = bench.publisher(COMMAND)
    for _ in range(3):
        handled = node.pacing.timing_counts.samples
        first.publish(Float64())
        bench.spin(lambda before=handled: node.pacing.timing_counts.samples > before)
    second = bench.publisher(COMMAND)
    one = node.accepted_publishers[COMMAND.name]
    for _ in range(50):
        rejected = one.rejected
        second.publish(Float64(data=10.0))
        bench.spin(lambda before=rejected: one.rejected == before + 1)
    # 10 V accelerate the arm by 450 rad/s²: one sample would show.
    assert abs(node.x[1]) < 0.2
    assert "2 nodes publish command: /probe and /probe" in capfd.readouterr().err
