"""Compiles all compiled functions once, so that the first run finds them in the cache."""

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from furuta.axis.axis import Axis, Pid, servo_cycle
from furuta.axis.simulation import simulate_axis
from furuta.describing_functions.predicted_cycles import predict_cycles
from furuta.lanes.lanes import compile_stages
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.loops import make_loop
from furuta.studies.analysis_options import AnalysisOptions
from furuta.studies.feedback_map import predicted_peak_to_peak
from furuta.transfer import transfer
from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.settings.settings import default_settings
from furuta_model.friction.parameters import Friction
from furuta_ros.context import ros_context
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
    loop = AnalysisOptions(law="lugre").ideal_loop()
    limit_cycle(loop)
    predicted_peak_to_peak(loop)
    predict_cycles(transfer(loop.body, loop.gains), loop.law)
    servo_cycle(Axis(1.0, Friction()), Pid(1.0, 1.0, 1.0))
    simulate_axis(Axis(1.0, Friction()), Pid(1.0, 1.0, 1.0), seconds=0.01)


def compile_nodes() -> None:
    """What the nodes call for each message."""
    with ros_context(private=True):
        SimulatedGraph(default_settings()).close()


def compile_side_by_side(*parts: Callable[[], object]) -> None:
    """Call each part in a process of its own; the files of the cache are what remains."""
    with ProcessPoolExecutor(mp_context=get_context("fork")) as pool:
        for part in [pool.submit(part) for part in parts]:
            part.result()


if __name__ == "__main__":
    compile_side_by_side(compile_loop, compile_library)
    compile_side_by_side(compile_lanes, compile_nodes)  # both need the loop
