"""``furuta run`` in one process."""

from __future__ import annotations

from pathlib import Path

import rclpy
from rclpy.signals import SignalHandlerOptions

from furuta_ros.spinning import Stop, spin_until
from furuta_sim.realtime import RealTime

from .graph import Graph
from .recorder import Recorder
from .settings import Settings


def run_composed(settings: Settings, record: Path | None, seconds: float | None) -> None:
    """Run the graph until it is told to stop or the pendulum's time is up."""
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        others = []
        if record is not None:
            others.append(Recorder(record, settings["plant"].get("clock") == "lockstep"))
        graph = Graph(settings, others)
        try:
            stop = Stop()
            plant = graph.plant
            spin_until(graph.executor, lambda: stop() or (seconds is not None and plant.paused))
            _report(graph)
        finally:
            graph.close()
    finally:
        rclpy.try_shutdown()


def _report(graph: Graph) -> None:
    plant = graph.plant
    print(f"{plant.sample} samples, {plant.time:.3f} s")
    if isinstance(plant.clockwork, RealTime):
        count = plant.clockwork.punctuality
        share = count.on_time / max(1, count.samples)
        print(
            f"{share:.2%} of {count.samples} samples had their command before the next one; "
            f"{count.overruns} overruns, {count.timeouts} samples at 0 V for want of a command"
        )
