"""Compiles all compiled functions once, so that the first run finds them in the cache."""

from __future__ import annotations

from furuta_analysis.describing_functions.predicted_cycles import predict_cycles
from furuta_analysis.limit_cycles.limit_cycle import limit_cycle
from furuta_analysis.simulation.closed_loop import Loop, simulate
from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.settings import default_settings
from furuta_model.transfer import transfer
from furuta_ros.context import ros_context
from furuta_studies.analysis_options import AnalysisOptions
from furuta_studies.feedback_map import predicted_peak_to_peak

if __name__ == "__main__":
    simulate(Loop(), 0.01)
    loop = AnalysisOptions((), (), "lugre", None).ideal_loop()
    limit_cycle(loop)
    predicted_peak_to_peak(loop)
    predict_cycles(transfer(loop.body, (loop.l1, loop.l2, loop.l3, loop.l4)), loop.law)
    with ros_context():
        SimulatedGraph(default_settings()).close()
