"""The paper's experiment through the real graph: Figs 6 to 8 in sequence.

In lock-step, one pendulum runs on while the compensation is switched by the parameter services.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from rclpy.node import Node

from furuta_analysis.oscillation import measure_oscillation
from furuta_model.parameters import ParameterError

from .bag import Recording
from .graph import Graph
from .operator import Operator
from .recorder import Recorder
from .settings import Settings

COMPENSATIONS = ("none", "coulomb", "lugre")
# Part of each phase that counts: the last half, after the transients.
SETTLED = 0.5


class Phase(NamedTuple):
    """One compensation and when it was in force [s]."""

    compensation: str
    start: float
    end: float
    wall_seconds: float


def run_demo(
    settings: Settings, seconds: float, bag: Path, progress: Callable[[float], None]
) -> list[Phase]:
    """Run every compensation for ``seconds``, recording into ``bag``.

    ``progress`` is told the pendulum's time now and then.
    """
    settings = {node: dict(given) for node, given in settings.items()}
    settings["plant"] |= {"clock": "lockstep", "run_until": 0.0}
    settings["friction_observer"]["compensation"] = COMPENSATIONS[0]
    person = Node("person")
    recorder = Recorder(bag, stamped=True)
    graph = Graph(settings, [recorder, person])
    try:
        graph.plant.create_timer(0.1, lambda: progress(graph.plant.time))
        operator = Operator(person, graph.executor)
        phases = []
        for number, compensation in enumerate(COMPENSATIONS):
            began = perf_counter()
            end = (number + 1) * seconds
            operator.set("friction_observer", compensation=compensation)
            operator.set("plant", run_until=end)
            graph.run_until(end)
            phases.append(Phase(compensation, number * seconds, end, perf_counter() - began))
        progress(graph.plant.time)
        return phases
    finally:
        graph.close()


def evaluate(phases: list[Phase], recording: Recording) -> list[dict[str, Any]]:
    """What each phase came to, on the recorded truth."""
    rows = []
    for phase in phases:
        settled = recording.between(phase.start + SETTLED * (phase.end - phase.start), phase.end)
        oscillation = measure_oscillation(settled.state, float(np.diff(settled.time).mean()))
        rows.append(
            {
                "compensation": phase.compensation,
                "phi_peak_to_peak_rad": oscillation.phi_peak_to_peak_rad,
                "theta_peak_to_peak_rad": oscillation.theta_peak_to_peak_rad,
                "period_s": oscillation.period_s,
                "command_rms_v": float(np.sqrt(np.mean(settled.command**2))),
                "samples": len(recording.between(phase.start, phase.end).time),
                "sim_seconds": phase.end - phase.start,
                "wall_seconds": phase.wall_seconds,
            }
        )
    return rows


def check_seconds(seconds: float) -> None:
    """Refuse a phase too short to hold a limit cycle (2.4 s) after its transients."""
    if not 5.0 <= seconds <= 3600.0:
        raise ParameterError(f"--seconds must be 5 to 3600, given {seconds:g}")
