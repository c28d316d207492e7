"""``furuta run`` in one process."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import rclpy
from rclpy.signals import SignalHandlerOptions

from furuta_graph.composed import Graph, HardwareGraph, Ring
from furuta_graph.settings import Settings
from furuta_recordings.recorder_node import MakeRecorder
from furuta_ros.scheduling import Scheduling, schedule
from furuta_ros.spinning import Stop, spin_until
from furuta_sim.realtime import RealTime

AnyRing = TypeVar("AnyRing", bound=Ring)


def run_composed(
    settings: Settings,
    record: MakeRecorder | None,
    seconds: float | None,
    scheduling: Scheduling = Scheduling(),  # noqa: B008 - immutable
    timing: Path | None = None,
) -> None:
    """Run the graph until it is told to stop or the pendulum's time is up.

    ``timing`` is a table of how late samples were.
    """
    with _running(Graph, settings, record, scheduling) as graph:
        stop, plant = Stop(), graph.plant
        spin_until(graph.executor, lambda: stop() or (seconds is not None and plant.paused))
        _report(graph)
        if timing is not None:
            _write_timing(graph, timing)


def run_on_hardware(
    settings: Settings,
    record: MakeRecorder | None,
    seconds: float | None,
    scheduling: Scheduling = Scheduling(),  # noqa: B008 - immutable
) -> None:
    """Run the graph on a rig until it is told to stop or the rig's time is up."""
    with _running(HardwareGraph, settings, record, scheduling) as graph:
        stop, bridge = Stop(), graph.bridge
        if bridge.state != bridge.parameters.autostart:
            raise SystemExit(1)  # the bridge has said why in its log
        period = bridge.rig.line.sample_time
        print(f"{bridge.state}, not armed; to drive the rig: furuta hw arm", flush=True)
        spin_until(
            graph.executor,
            lambda: stop() or (seconds is not None and bridge.samples * period >= seconds),
        )
        print(f"{bridge.samples} samples, {bridge.guard.stops} stops")


@contextmanager
def _running(
    make: Callable[..., AnyRing],
    settings: Settings,
    record: MakeRecorder | None,
    scheduling: Scheduling,
) -> Iterator[AnyRing]:
    """The graph from ROS's start to its end; says what of ``scheduling`` the system granted."""
    for granted in schedule(scheduling):
        print(granted)
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        graph = make(settings, record=record)
        try:
            yield graph
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
        print(f"latency   {plant.clockwork.latency.summary()}")
        print(f"lateness  {plant.clockwork.lateness.summary()}")


def _write_timing(graph: Graph, path: Path) -> None:
    """Both histograms, a row per microsecond that anything was counted in."""
    clockwork = graph.plant.clockwork
    if not isinstance(clockwork, RealTime):
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["from_us", "latency", "lateness"])
        counts = zip(clockwork.latency.counts, clockwork.lateness.counts, strict=True)
        writer.writerows([us, a, b] for us, (a, b) in enumerate(counts) if a or b)
