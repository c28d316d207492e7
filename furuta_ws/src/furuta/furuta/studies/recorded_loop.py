"""A recorded session of the graph, and its comparison with a recomputation."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from furuta_ros.time_stamps import NANOSECONDS
from furuta_sim.simulation.recomputation import Recomputed


class RecordedLoop(NamedTuple):
    """What a bag holds of the graph, one row per measurement.

    ``stamps`` (n,) [ns], ``measurement`` (n, 5). ``outputs`` are what the nodes computed, NaN where
    nothing was recorded. ``changes``: (sample, node, {parameter: value}) of parameters set.
    """

    stamps: np.ndarray
    measurement: np.ndarray
    outputs: Recomputed
    changes: list[tuple[int, str, dict[str, Any]]]

    @property
    def time(self) -> np.ndarray:
        """Time since the first sample (n,) [s]."""
        elapsed: np.ndarray = (self.stamps - self.stamps[0]) / NANOSECONDS
        return elapsed


def compare(recorded: RecordedLoop, recomputed: Recomputed) -> dict[str, Any]:
    """Largest and rms difference of each series over the samples that were recorded."""
    result: dict[str, Any] = {"samples": len(recorded.time), "identical": True}
    for name in Recomputed._fields:
        result[name] = _compare_series(getattr(recorded.outputs, name), getattr(recomputed, name))
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
