"""``furuta run`` in one process."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import rclpy
from rclpy.signals import SignalHandlerOptions

from furuta_graph.composed import ComposedGraph, HardwareGraph, SimulatedGraph
from furuta_graph.settings import Settings
from furuta_recordings.recorder_node import MakeRecorder
from furuta_ros.scheduling import Scheduling, schedule
from furuta_ros.spinning import StopSignal, spin_until
from furuta_sim.realtime import RealTime

AnyGraph = TypeVar("AnyGraph", bound=ComposedGraph)


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
    with _running(SimulatedGraph, settings, record, scheduling) as graph:
        stop, plant = StopSignal(), graph.plant
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
        stop, bridge = StopSignal(), graph.bridge
        bridge.start()
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
    make: Callable[..., AnyGraph],
    settings: Settings,
    record: MakeRecorder | None,
    scheduling: Scheduling,
) -> Iterator[AnyGraph]:
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


def _report(graph: SimulatedGraph) -> None:
    plant = graph.plant
    print(f"{plant.sample} samples, {plant.time:.3f} s")
    if isinstance(plant.pacing, RealTime):
        count = plant.pacing.timing_counts
        share = count.on_time / max(1, count.samples)
        print(
            f"{share:.2%} of {count.samples} samples had their command before the next one; "
            f"{count.overruns} overruns, {count.timeouts} samples at 0 V for want of a command"
        )
        print(f"latency   {plant.pacing.latency.summary()}")
        print(f"lateness  {plant.pacing.lateness.summary()}")


def _write_timing(graph: SimulatedGraph, path: Path) -> None:
    """Both histograms, a row per microsecond that anything was counted in."""
    pacing = graph.plant.pacing
    if not isinstance(pacing, RealTime):
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["from_us", "latency", "lateness"])
        counts = zip(pacing.latency.counts, pacing.lateness.counts, strict=True)
        writer.writerows([us, a, b] for us, (a, b) in enumerate(counts) if a or b)
