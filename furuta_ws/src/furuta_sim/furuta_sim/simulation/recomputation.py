"""Recomputes estimates and commands from recorded measurements, as the nodes compute them."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from furuta_control.estimation import pass_skipped, skipped_samples
from furuta_friction.compensation import allow
from furuta_model.block import new_memory
from furuta_model.compiled import compiled
from furuta_model.state import SIGNALS
from furuta_ros.time_stamps import NANOSECONDS, starts_anew
from furuta_sim.simulation.closed_loop import Loop
from furuta_sim.simulation.control_system import (
    ControlMemory,
    ControlSystem,
    control_sample,
    design_control_system,
    reset,
)


class Recomputed(NamedTuple):
    """Recomputed series: estimate (n, 5), friction estimate (n,) [V] and command (n,) [V]."""

    estimate: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray


def new_starts(stamps: np.ndarray) -> list[int]:
    """Samples that do not continue the ones before, as after a reset."""
    return [k for k in range(1, len(stamps)) if starts_anew(int(stamps[k - 1]), int(stamps[k]))]


def recompute(
    measurement: np.ndarray,
    changes: list[tuple[int, Loop]],
    stamps: np.ndarray,
) -> Recomputed:
    """Process ``measurement`` (n, 5) of ``stamps`` (n,) [ns] as the three nodes do.

    ``changes`` lists parameters and the sample from which they apply; the first must be 0. The
    memories are kept over a change.
    """
    n = len(measurement)
    result = Recomputed(np.empty((n, SIGNALS)), np.empty(n), np.empty(n))
    memory = new_memory(ControlMemory)
    loops = dict(changes)
    starts = new_starts(stamps)
    period = changes[0][1].estimator.sample_time * NANOSECONDS
    intervals = np.diff(stamps, prepend=stamps[:1])
    skipped = np.array([skipped_samples(interval, period) for interval in intervals])
    skipped[starts] = 0
    bounds = sorted({*loops, *starts, n})
    observer = changes[0][1].observer
    for start, end in pairwise(bounds):
        if start in loops:
            control_system = design_control_system(*loops[start][1:])
            if loops[start].observer != observer:
                allow(memory[0]["observer"])
            observer = loops[start].observer
        if start in starts:
            reset(memory[0])
        _run(
            # The estimator replaces unusable readings.
            measurement[start:end].copy(),
            memory,
            control_system,
            skipped[start:end],
            Recomputed(*(series[start:end] for series in result)),
        )
    return result


@compiled
def _run(
    measurement: np.ndarray,
    memory: np.ndarray,
    control_system: ControlSystem,
    skipped: np.ndarray,
    result: Recomputed,
) -> None:
    for k in range(len(measurement)):
        if skipped[k]:
            pass_skipped(
                memory[0].estimator,
                skipped[k],
                measurement[k],
                control_system.estimator,
                result.estimate[k],
            )
        result.friction_estimate[k], result.command[k] = control_sample(
            memory[0], measurement[k], control_system, result.estimate[k]
        )
