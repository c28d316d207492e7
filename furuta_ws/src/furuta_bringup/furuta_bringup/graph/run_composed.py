"""Running the composed graph until it is stopped, with a report at the end."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TypeVar

from furuta.settings.nodes import PLANT
from furuta_bringup.graph.composed_graph import ComposedGraph, HardwareGraph, SimulatedGraph
from furuta_bringup.graph.graph_plan import Graph, tell_running
from furuta_bringup.graph.scheduling import Scheduling, apply_scheduling
from furuta_bringup.printing import with_status
from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_recordings.recorder_node import MakeRecorder
from furuta_ros.errors import UserError
from furuta_ros.one_graph import namespace_option
from furuta_ros.process import StopSignal, bounded_end
from furuta_ros.spinning import ros_context, spin_until

# Time without a sample after which a run of limited time ends [s]: it is counted in samples.
LONGEST_SILENCE = 10.0

AnyGraph = TypeVar("AnyGraph", bound=ComposedGraph)


def run_simulated(
    graph: Graph,
    record: MakeRecorder | None,
    seconds: float | None,
    scheduling: Scheduling = Scheduling(),  # noqa: B008 - immutable
) -> None:
    """Run the graph with the simulated plant until it is stopped or ``seconds`` have passed."""
    with _running(SimulatedGraph, graph, record, scheduling) as running:
        stop, plant = StopSignal(), running.plant
        tell_running(graph)
        # In real time nothing else may take the processor.
        quiet = seconds is None or graph.settings[PLANT].get("clock") != "lockstep"
        with with_status(f"simulating {seconds} s", quiet):
            spin_until(running.executor, lambda: stop() or (seconds is not None and plant.paused))
        print(plant.summary())


def run_hardware(
    graph: Graph,
    record: MakeRecorder | None,
    seconds: float | None,
    scheduling: Scheduling = Scheduling(),  # noqa: B008 - immutable
) -> None:
    """Run the graph with a rig until it is stopped or ``seconds`` of its time have passed.

    Raises:
        UserError: The rig was silent for :data:`LONGEST_SILENCE` in a run of limited time.
    """
    with _running(HardwareGraph, graph, record, scheduling) as running:
        stop, bridge = StopSignal(), running.bridge
        if bridge.start_up():
            raise SystemExit(1)  # the bridge has logged the reason
        tell_running(graph)
        is_over = _time_limit(bridge, seconds)
        arm = f"furuta hw arm{namespace_option(graph.namespace)}"
        print(f"{bridge.state}, not armed; to drive the rig: {arm}", flush=True)
        spin_until(running.executor, lambda: stop() or is_over())
        print(bridge.summary())


def _time_limit(bridge: HardwareBridgeNode, seconds: float | None) -> Callable[[], bool]:
    """Whether ``seconds`` of the rig's time have passed, if given; to be called often.

    Raises:
        UserError: The rig was silent for :data:`LONGEST_SILENCE`.
    """
    samples, since = bridge.samples, monotonic()

    def is_reached() -> bool:
        nonlocal samples, since
        if seconds is None:
            return False
        if samples != bridge.samples:
            samples, since = bridge.samples, monotonic()
        elapsed = samples * bridge.rig.line.sample_time
        if monotonic() - since > LONGEST_SILENCE:
            raise UserError(
                f"the rig has sent no sample for {LONGEST_SILENCE:g} s, after {elapsed:.3f} s of "
                f"the {seconds:g} s asked for"
            )
        return elapsed >= seconds

    return is_reached


@contextmanager
def _running(
    make: Callable[..., AnyGraph],
    graph: Graph,
    record: MakeRecorder | None,
    scheduling: Scheduling,
) -> Iterator[AnyGraph]:
    """The composed graph from ROS's start to its end; prints the results of ``scheduling``.

    Raises:
        UserError: The recording ended before the graph.
    """
    for result in apply_scheduling(scheduling):
        print(result)
    with ros_context(namespace=graph.namespace):
        with with_status("starting the nodes"):
            composed = make(graph.settings, record=record, without=graph.without)
        try:
            yield composed
        finally:
            composed.end_recording()
            failed = composed.recording_failure is not None or sys.exc_info()[0] is not None
            with bounded_end(int(failed)):
                composed.close()
    if composed.recording_failure is not None:
        raise UserError(f"the recording is incomplete: {composed.recording_failure}")
