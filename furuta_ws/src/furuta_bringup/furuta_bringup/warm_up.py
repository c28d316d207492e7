"""Compiles functions before they are called, in processes side by side: ``python -m`` this module.

The files of the cache are what remains. ``furuta demo`` compiles its nodes in this way, and the
tests compile everything.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import Any

from furuta.axis.axis import Axis, Pid, servo_cycle
from furuta.axis.simulation import simulate_axis
from furuta.describing_functions.predicted_cycles import predict_cycles
from furuta.lanes.batch import available_cores
from furuta.lanes.lanes import compile_stages
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.loops import ideal_loop, make_loop
from furuta.settings.nodes import graph_nodes
from furuta.studies.feedback_map import predicted_peak_to_peak
from furuta.transfer import transfer
from furuta_bringup.printing import with_progress
from furuta_model.accepted_parts import accept_parts, accepted_parts
from furuta_model.friction.parameters import Friction
from furuta_ros.spinning import ros_context
from furuta_sim.simulation.closed_loop import Loop, simulate

# Compensations whose stages are compiled for batches; others are compiled when they are worth it.
IN_LANES = ("none", "coulomb", "lugre")


def compile_loop() -> None:
    """The closed loop."""
    simulate(Loop(), 0.01)


def compile_lanes() -> None:
    """Batches with the paper's sensors, and with ideal ones."""
    compile_stages(make_loop({"compensation": name}) for name in IN_LANES)
    compile_stages([make_loop({"sensors.ideal": True})])


def compile_library() -> None:
    """Exact and predicted limit cycles, servo axes."""
    loop = ideal_loop(law="lugre")
    limit_cycle(loop)
    predicted_peak_to_peak(loop)
    predict_cycles(transfer(loop.body, loop.gains), loop.law)
    servo_cycle(Axis(1.0, Friction()), Pid(1.0, 1.0, 1.0))
    simulate_axis(Axis(1.0, Friction()), Pid(1.0, 1.0, 1.0), seconds=0.01)


def compile_node(name: str) -> None:
    """What a node calls for each message."""
    (node,) = (node for node in graph_nodes() if node.name == name)
    with ros_context(private=True):
        node.load_class()().destroy_node()


def workers() -> ProcessPoolExecutor:
    """A pool with a process for each core, which accepts the same parts of one's own."""
    # A forked child of a process with threads may wait for a lock for ever.
    context = get_context("spawn")
    return ProcessPoolExecutor(available_cores(), context, accept_parts, (accepted_parts(),))


def compile_nodes(pool: ProcessPoolExecutor, quiet: bool = False) -> None:
    """Compile what the nodes of the simulated graph call, and show how far it is."""
    _wait((pool.submit(compile_node, node.name) for node in graph_nodes()), quiet)


def compile_all() -> None:
    """Compile everything, what takes longest first."""
    parts: list[Callable[[], None]] = [compile_library, compile_loop, compile_lanes]
    with workers() as pool:
        begun = [pool.submit(part) for part in parts]
        begun += [pool.submit(compile_node, node.name) for node in graph_nodes()]
        _wait(begun)


def _wait(tasks: Iterable[Future[Any]], quiet: bool = False) -> None:
    tasks = list(tasks)
    for task in with_progress("compiling", as_completed(tasks), len(tasks), quiet=quiet):
        task.result()


if __name__ == "__main__":
    compile_all()
