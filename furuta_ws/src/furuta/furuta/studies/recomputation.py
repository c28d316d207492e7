"""Recomputes a recorded session of the graph with recorded or other parameters, as its nodes do."""

from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from furuta_control.estimation import pass_skipped, skipped_samples
from furuta_friction.compensation import allow
from furuta_model.block import new_memory
from furuta_model.compiled import compiled
from furuta_model.state import SIGNALS
from furuta_recordings.bags.bag_files import parameter_file_of
from furuta_recordings.bags.recorded_loop import RecordedLoop, read_recorded_loop
from furuta_ros.time_stamps import NANOSECONDS, starts_anew
from furuta_sim.settings.settings import Settings, load_settings, loop, merge_settings, read_file
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


def recompute_bag(
    bag: Path, files: tuple[Path, ...], assignments: tuple[str, ...]
) -> tuple[RecordedLoop, Recomputed]:
    """Recompute a session with the recorded parameters; given ones take precedence."""
    recorded = read_recorded_loop(bag)
    file = parameter_file_of(bag)
    base = load_settings([], []) if file is None else read_file(file)
    # Defaults replace parameters that another version did not record.
    given = load_settings(files, assignments)
    loops = [(0, loop(merge_settings(base, given)))]
    for sample, node, changed in recorded.changes:
        if node in base:
            base = merge_settings(base, _settings_of(base, node, changed))
            loops.append((sample, loop(merge_settings(base, given))))
    return recorded, recompute(recorded.measurement, loops, recorded.stamps)


def _settings_of(settings: Settings, node: str, changed: dict[str, Any]) -> Settings:
    return {name: (changed if name == node else {}) for name in settings}


def compare(recorded: RecordedLoop, recomputed: Recomputed) -> dict[str, Any]:
    """Largest and rms difference of each series over the samples that were recorded."""
    result: dict[str, Any] = {"samples": len(recorded.time), "identical": True}
    for name in Recomputed._fields:
        result[name] = _compare_series(getattr(recorded, name), getattr(recomputed, name))
        result["identical"] &= result[name]["identical"]
    return result


def _compare_series(old: np.ndarray, new: np.ndarray) -> dict[str, Any]:
    known = np.isfinite(old)
    difference = (new - old)[known]
    return {
        "identical": bool(np.array_equal(new[known], old[known])),
        "compared": int(np.sum(known)),
        "largest_difference": float(np.max(np.abs(difference), initial=0.0)),
        "rms_difference": float(np.sqrt(np.mean(difference**2))) if len(difference) else 0.0,
    }
